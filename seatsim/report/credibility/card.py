"""The credibility card: a row for each factor with its level, its evidence, and what the next level asks for."""

from __future__ import annotations

from collections.abc import Iterator

from seatsim.report.blocks import Section, Table, Text
from seatsim.report.credibility.evidence import Evidence
from seatsim.report.credibility.rules import FACTORS, find_level
from seatsim.report.formatting import UNKNOWN, format_sentence

HIGHEST = 4
LEAD = (
    "Levels 0 to 4 of the factors of NASA-STD-7009B. Each follows by a rule from what this very result shows, and says"
    " nothing of what was checked elsewhere."
)


def show_card(evidence: Evidence) -> Section:
    """Return the section on how far the figures of a report may be trusted."""
    head = ["factor", "level", "evidence", "next level if"]
    table = Table("Credibility of the figures of this report", head, list(_list_rows(evidence)), words=4)
    return Section("credibility", "How far to trust this", [Text(LEAD), table])


def _list_rows(evidence: Evidence) -> Iterator[list[str]]:
    for factor in FACTORS:
        level = find_level(factor, evidence)
        is_last = level is None or level == len(factor.conditions)
        following = UNKNOWN if is_last else factor.conditions[level or 0].words
        yield [
            factor.name,
            UNKNOWN if level is None else f"{level}\u00a0of\u00a0{HIGHEST}",
            format_sentence(factor.describe(evidence)),
            following,
        ]
