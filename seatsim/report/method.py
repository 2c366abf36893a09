"""The end of every report: how its figures were made, with which settings and versions, and how to make it again."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

from seatsim.provenance.statement import state_command
from seatsim.report.blocks import Block, Code, Items, Section, Table, Text

_PACKAGES = ("seatsim", "numpy", "scipy", "numba")


def describe_method(method: Sequence[str], command: str, settings: Sequence[Block] = ()) -> Section:
    """Return the section on method, settings, versions and how to make the report again.

    Args:
        method: sentences on how the figures were made.
        command: what makes the report again; of a command at work, this one with its options is stated instead.
        settings: tables of them.
    """
    again: list[Block] = [Text("This command makes the report again:"), Code(state_command(command))]
    versions = Table("Versions", ["package", "version"], [[name, version(name)] for name in _PACKAGES], 2)
    return Section("method", "How this was made", [Items(list(method)), *settings, versions, *again])
