"""The credibility card: a row for each factor with its level, its evidence, and what the next level asks for."""

from __future__ import annotations

from collections.abc import Iterator

from seatsim.plots.labels import UNKNOWN
from seatsim.report.blocks import Section, Table, Text
from seatsim.report.credibility.evidence import Evidence
from seatsim.report.credibility.rules import FACTORS, REACH, Factor, find_level
from seatsim.report.formatting import format_sentence

_LEAD = (
    "Levels of the factors of NASA-STD-7009B, as far as such a result can reach them. Each follows by a rule from what"
    " this very result shows, and says nothing of what was checked elsewhere."
)


def show_card(evidence: Evidence) -> Section:
    """Return the section on how far the figures of a report may be trusted."""
    head = ["factor", "level", "evidence", "next level if"]
    rows = [
        [
            factor.name,
            f"{level}\u00a0of\u00a0{highest}",
            format_sentence(factor.describe(evidence)),
            factor.conditions[level].words if level < highest else UNKNOWN,
        ]
        for factor, level, highest in _list_levels(evidence)
    ]
    table = Table("Credibility of the figures of this report", head, rows, words=4)
    return Section("credibility", "How far to trust this", [Text(_LEAD), table])


def say_doubt(evidence: Evidence) -> str:
    """Return in a sentence which factor falls the furthest behind what could be reached; empty where none does."""
    weakest = min(_list_levels(evidence), key=lambda row: row[1] / row[2])
    factor, level, highest = weakest
    return (
        "" if level == highest else format_sentence(f"least certain is the {factor.name}: {factor.describe(evidence)}")
    )


def _list_levels(evidence: Evidence) -> Iterator[tuple[Factor, int, int]]:
    """Yield the factors that such a result can have, each with its level and the highest that can be reached."""
    for factor in FACTORS:
        highest = find_level(factor, REACH[evidence.kind])
        if highest:
            yield factor, min(highest, find_level(factor, evidence)), highest
