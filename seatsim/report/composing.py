"""How every report is put together: its answer and sections, notes, how it was made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import version

from seatsim.provenance.statement import state_command
from seatsim.report.blocks import Block, Code, Items, Report, Section, Text
from seatsim.report.formatting import format_sentence, read_words, show_table

_PACKAGES = ("seatsim", "numpy", "scipy", "numba")


def compose(
    kind: str,
    about: str,
    answer: Sequence[str],
    next_steps: Sequence[str],
    sections: Mapping[str, Sequence[Block]],
    notes: Sequence[str],
    command: str,
    settings: Sequence[Block] = (),
    **facts: str,
) -> Report:
    """Return a report.

    Args:
        kind: by which its method and the headings of its sections are known.
        about: what it is on.
        answer: in a sentence, and further ones.
        next_steps: what to do next.
        sections: its own by anchor; notes and method follow them.
        notes: on the data.
        command: what makes it again; of a command at work, this one with its options is stated instead.
        settings: tables of them.
        facts: what the sentences on the method leave open.
    """
    words = read_words()
    method = [text.format(**facts) for text in words.methods[kind]]
    versions = show_table("versions", [(name, version(name)) for name in _PACKAGES], 2)
    again: list[Block] = [Text("This command makes the report again:"), Code(state_command(command))]
    own = [Section(anchor, words.headings[kind][anchor], blocks) for anchor, blocks in sections.items()]
    sentences = list(dict.fromkeys(map(format_sentence, notes)))
    ends = [
        Section("notes", "Notes", [Items(sentences)] if sentences else []),
        Section("method", "How this was made", [Items(method), *settings, *versions, *again]),
    ]
    return Report(about, answer[0], answer[1:], next_steps, [*own, *ends])
