"""What several answers have: the files that were written, a gap, a name, and the answer of a failure."""

from __future__ import annotations

from typing_extensions import TypedDict

Figures = dict[str, float | None]


class Answer(TypedDict):
    """What all commands print: the files that were written."""

    files: list[str]


class Gap(TypedDict):
    """A gap in standard deviations of the measured signals."""

    overall: float | None
    channels: Figures


class Name(TypedDict):
    """A name that can stand in a scenario."""

    name: str
    kind: str
    title: str
    text: str
    source: str
    own: bool
    keys: list[dict[str, object]]


class ErrorAnswer(TypedDict):
    """What any command prints where it ends with an error."""

    error: str
