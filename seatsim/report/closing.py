"""The end of every report: notes, how far to trust it, how it was made, and how to make it again."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

from seatsim.plots.densities import METHOD
from seatsim.provenance.statement import state_command
from seatsim.report.blocks import Block, Code, Items, Section, Text, list_notes, tabulate
from seatsim.report.credibility import Factor, show_card
from seatsim.report.formatting import format_sentence
from seatsim.report.words import read_words

_PACKAGES = ("seatsim", "numpy", "scipy", "numba")


def close_report(
    kind: str,
    notes: Sequence[str],
    factors: Sequence[Factor],
    command: str,
    settings: Sequence[Block] = (),
    **facts: str,
) -> list[Section]:
    """Return the sections at the end of a report.

    Args:
        kind: of the report, by which its method is known.
        notes: on the data.
        factors: of its credibility.
        command: what makes the report again; of a command at work, this one with its options is stated instead.
        settings: tables of them.
        facts: what the sentences on the method leave open.
    """
    method = [text.format(density=METHOD, **facts) for text in read_words().methods[kind]]
    versions = tabulate("Versions", "package, version", [(name, version(name)) for name in _PACKAGES], 2)
    again: list[Block] = [Text("This command makes the report again:"), Code(state_command(command))]
    return [
        Section("notes", "Notes", list_notes(list(map(format_sentence, notes)))),
        show_card(factors),
        Section("method", "How this was made", [Items(method), *settings, *versions, *again]),
    ]
