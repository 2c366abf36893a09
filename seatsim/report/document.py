"""The shell of a page: its look, a list of contents, and sections; those without content are left out."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from typing import NamedTuple

from seatsim.report.html import Html, join, tag


class FilledSection(NamedTuple):
    """A part of a page: its anchor, heading and content."""

    anchor: str
    heading: str
    content: Html


def render_document(title: str, header: Html, sections: Sequence[FilledSection]) -> str:
    """Return a self-contained HTML page; sections without content are left out."""
    shown = [section for section in sections if section.content]
    body = tag("main", header, _render_contents(shown), *map(_render_section, shown))
    return f"<!DOCTYPE html>\n{tag('html', _render_head(title), tag('body', body), lang='en')}\n"


def _render_head(title: str) -> Html:
    look = files(__package__).joinpath("report.css").read_text(encoding="utf-8")
    return tag(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        tag("title", title),
        tag("style", Html(look)),
    )


def _render_contents(sections: Sequence[FilledSection]) -> Html:
    links = [tag("a", section.heading, href=f"#{section.anchor}") for section in sections]
    return tag("nav", join(links, " "), aria_label="Contents")


def _render_section(section: FilledSection) -> Html:
    return tag("section", tag("h2", section.heading), section.content, id=section.anchor)
