"""The page of a diagnosis: its sections in their order."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from seatsim.diagnosis.result import Diagnosis
from seatsim.report import answer, causes, evidence
from seatsim.report.document import FilledSection, render_document
from seatsim.report.html import Html


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
    filled = [FilledSection(section.anchor, section.heading, section.content(diagnosis)) for section in chosen]
    return render_document(f"{diagnosis.name}: {diagnosis.sentence}", answer.render_head(diagnosis), filled)
