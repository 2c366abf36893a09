"""What a change of a carrier is: an effect of the library at work in it, by an amount that can be set."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import NamedTuple

from numpy.random import Generator

from seatsim.blind.carrier.recorded import Carrier, Table


class Altered(NamedTuple):
    """A changed carrier with the true parameters, under the names that the effect's own parameters have."""

    carrier: Carrier
    parameters: Mapping[str, float]


class Change(NamedTuple):
    """An effect in one form: `alter` gives the carrier with the effect at an amount inside `span`.

    `effect` is a name of the contract, `form` how it was put in, `channel` that of a sensor effect, else empty.
    """

    effect: str
    form: str
    channel: str
    span: tuple[float, float]
    alter: Callable[[float], Altered]


Drawer = Callable[[Carrier, Generator], list[Change]]
"""Returns the changes of a kind that a carrier allows, with what is random about them drawn."""


def with_tables(carrier: Carrier, table_of: Callable[[Table], Table]) -> Carrier:
    """Return the carrier with every run replaced."""
    return dataclasses.replace(carrier, tables={run: table_of(table) for run, table in carrier.tables.items()})
