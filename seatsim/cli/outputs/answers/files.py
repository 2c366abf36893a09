"""Answers of the commands on files: describe, new, check, explore, reproduce."""

from __future__ import annotations

from typing_extensions import TypedDict

from seatsim.cli.outputs.answers.common import Answer, Name


class DescriptionAnswer(Answer):
    """All names, or the one that was asked for."""

    names: list[Name]


class NewAnswer(Answer):
    """What was written."""

    kind: str


class CheckAnswer(Answer):
    """A file without errors."""

    file: str
    kind: str
    holds: list[str]
    warnings: list[str]


class ExploreAnswer(Answer):
    """A page that is served until the command is interrupted."""

    address: str


class DifferenceFound(TypedDict):
    """An input or a file that is not as it was."""

    path: str
    problem: str


class ReproduceAnswer(Answer):
    """What came of running a command again, as in `reproduce.json`."""

    command: str
    identical: bool
    compared: list[str]
    differences: list[DifferenceFound]
    versions: list[str]
    unnamed: list[str]
