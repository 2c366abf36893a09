"""A damper model as a fit sees it: a record whose fields are read and replaced by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, Self, TypeAlias, cast

from seatsim.cosimulation.damper import PREFIX
from seatsim.dampers.base import DAMPERS, DamperSpecification
from seatsim.kernel.protocols import DamperModel
from seatsim.schema.errors import InputError

FieldValue: TypeAlias = float | str | tuple[float, ...]
"""A number (an `int` too), one of several words, or the coefficients of a law in the current."""


class DamperRecord(DamperModel, Protocol):
    """A damper model's parameters: the `NamedTuple` that the model's class is."""

    def _asdict(self) -> dict[str, FieldValue]: ...

    def _replace(self, **changes: FieldValue) -> Self: ...


def find_model(name: str) -> type[DamperRecord]:
    """Return the class of a damper model.

    Raises:
        InputError: no damper has this name, or it is that of a unit.
    """
    if name.startswith(PREFIX):
        raise InputError(
            f"{name} is a unit of another program, whose parameters its supplier knows; a model of the library can be"
            " fitted to its bench tables, such as --model bouc_wen"
        )
    # A damper's record has fields of any type; those that a fit reads and replaces are numbers, words and laws.
    return cast("type[DamperRecord]", DAMPERS.find(name))


def find_specification(cls: type) -> DamperSpecification:
    """Return what is stated of a damper model's class."""
    return DAMPERS.specification_of(cls)


def law_range(fields: Mapping[str, FieldValue], default: float) -> float:
    """Return the current in A up to which a model's laws hold: its field `law_end`, or the default without one."""
    end = fields.get("law_end", default)
    assert isinstance(end, int | float)
    return float(end)
