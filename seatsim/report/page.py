"""The page: its sections in their order, and its look."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from typing import NamedTuple

from seatsim.diagnosis.result import Diagnosis
from seatsim.report import answer, causes, evidence
from seatsim.report.html import Html, join, tag


class PageSection(NamedTuple):
    """A part of the page: its anchor, heading, and what renders it; `short` ones are also shown without a gap."""

    anchor: str
    heading: str
    content: Callable[[Diagnosis], Html]
    short: bool = False


SECTIONS = (
    PageSection("gaps", "How far: gaps on held-out runs", answer.render_gaps, short=True),
    PageSection("causes", "Where it lies and what causes it", causes.render_causes),
    PageSection("missing", "What is missing", evidence.render_discrepancy),
    PageSection("forms", "Other forms of the damper", causes.render_forms, short=True),
    PageSection("confusions", "Which effects are collinear", causes.render_confusions),
    PageSection("signals", "Held-out signals before and after", evidence.render_signals),
    PageSection("maps", "Where in the operating range", evidence.render_maps),
    PageSection("spectra", "Residual spectra", evidence.render_spectra),
    PageSection("budget", "What the remaining error is made of", evidence.render_budget, short=True),
    PageSection("comfort", "Comfort and travel", evidence.render_comfort, short=True),
    PageSection("notes", "Notes on the data", evidence.render_notes, short=True),
    PageSection("use", "Check the result", evidence.render_use),
)


def render_page(diagnosis: Diagnosis) -> str:
    """Return the HTML page of a diagnosis; sections without content are left out."""
    chosen = [section for section in SECTIONS if section.short or diagnosis.verdict != "none"]
    filled = [(section, section.content(diagnosis)) for section in chosen]
    shown = [(section, content) for section, content in filled if content]
    body = tag(
        "main",
        answer.render_head(diagnosis),
        _render_contents([section for section, _ in shown]),
        *(_render_section(section, content) for section, content in shown),
    )
    return f"<!DOCTYPE html>\n{tag('html', _render_head(diagnosis), tag('body', body), lang='en')}\n"


def _render_head(diagnosis: Diagnosis) -> Html:
    look = files(__package__).joinpath("report.css").read_text(encoding="utf-8")
    return tag(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        tag("title", f"{diagnosis.name}: {diagnosis.sentence}"),
        tag("style", Html(look)),
    )


def _render_contents(sections: list[PageSection]) -> Html:
    links = [tag("a", section.heading, href=f"#{section.anchor}") for section in sections]
    return tag("nav", join(links, " "), aria_label="Contents")


def _render_section(section: PageSection, content: Html) -> Html:
    return tag("section", tag("h2", section.heading), content, id=section.anchor)
