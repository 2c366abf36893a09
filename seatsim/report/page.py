"""The page: its sections in their order, and its look."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from typing import NamedTuple

from seatsim.diagnosis.result import Diagnosis
from seatsim.report import answer, causes, evidence
from seatsim.report.html import Html, joined, tag


class Section(NamedTuple):
    """A part of the page: its anchor, heading, and what fills it; `short` ones are shown where there is no gap."""

    anchor: str
    heading: str
    content: Callable[[Diagnosis], Html]
    short: bool = False


SECTIONS = (
    Section("gaps", "How far: gaps on held-out runs", answer.gaps, short=True),
    Section("causes", "Where it lies and what causes it", causes.ranked),
    Section("missing", "What is missing", evidence.missing),
    Section("confusions", "What could be taken for what", causes.confusions),
    Section("signals", "Held-out signals before and after", evidence.before_and_after),
    Section("maps", "Where in the operating range", evidence.ranges),
    Section("spectra", "Residual spectra", evidence.frequencies),
    Section("comfort", "Comfort and travel", evidence.comfort, short=True),
    Section("notes", "Notes on the data", evidence.notes, short=True),
    Section("use", "Check the claim", evidence.use),
)


def page(diagnosis: Diagnosis) -> str:
    """Return the page of a diagnosis; sections without content are left out."""
    chosen = [section for section in SECTIONS if section.short or diagnosis.verdict != "none"]
    filled = [(section, section.content(diagnosis)) for section in chosen]
    shown = [(section, content) for section, content in filled if content]
    body = tag(
        "main",
        answer.head(diagnosis),
        _contents([section for section, _ in shown]),
        *(_section(section, content) for section, content in shown),
    )
    return f"<!DOCTYPE html>\n{tag('html', _head(diagnosis), tag('body', body), lang='en')}\n"


def _head(diagnosis: Diagnosis) -> Html:
    look = files(__package__).joinpath("report.css").read_text(encoding="utf-8")
    return tag(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        tag("title", f"{diagnosis.name}: {diagnosis.sentence}"),
        tag("style", Html(look)),
    )


def _contents(sections: list[Section]) -> Html:
    links = [tag("a", section.heading, href=f"#{section.anchor}") for section in sections]
    return tag("nav", joined(links, " "), aria_label="Contents")


def _section(section: Section, content: Html) -> Html:
    return tag("section", tag("h2", section.heading), content, id=section.anchor)
