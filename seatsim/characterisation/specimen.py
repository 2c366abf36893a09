"""A damper on the bench that is a model: its parameters, temperature factors and coil."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple, cast

from seatsim.dampers.base import DAMPERS, Damper, DamperSpecification
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.damper import read_damper
from seatsim.schema.registry import name_of, specification_of
from seatsim.schema.validation import build, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath


class DamperSpecimen(NamedTuple):
    """A damper model with its parameters, temperature factors and coil; `stated` where a file states them."""

    damper: Damper
    factors: TemperatureFactors
    coil: Coil
    stated: bool = True

    @property
    def name(self) -> str:
        """Name of the model."""
        return name_of("damper", type(self.damper))

    @property
    def specification(self) -> DamperSpecification:
        """What is stated of the model."""
        return _find_specification(type(self.damper))


def load_specimen(model: str | None, parameters: Path | None) -> DamperSpecimen:
    """Return a model with the values of its record, or with the `parameters` of a file.

    The file is a damper, `{model: NAME, parameters: {...}, temperature_factors: {...}}`, or has one under `damper`, as
    a scenario has, with its coil under `actuator`.

    Raises:
        InputError: there is no such model, the file is not as described, or it is of another model.
    """
    if parameters is None:
        cls = DAMPERS.find(model or "")
        specification = _find_specification(cls)
        return DamperSpecimen(cls(), specification.factors, Coil(max_current=specification.max_current), False)
    source = Source(Path(parameters))
    whole = "damper" in source.data
    keys: KeyPath = ("damper",) if whole else ()
    values = source.data["damper"] if whole else source.data
    damper, factors = (choice := read_damper(values, source, keys)).record, choice.factors
    named = mapping(values, source, keys)["model"]
    if model not in (None, named):
        problem = f"is '{named}', not the '{model}' of --model; leave --model out"
        raise source.error((*keys, "model"), problem)
    coil = Coil(max_current=_find_specification(type(damper)).max_current)
    if whole and "actuator" in source.data:
        coil = build(Coil, source.data["actuator"], source, ("actuator",), ("rate", "max_current"))
    return DamperSpecimen(damper, factors, coil)


def _find_specification(cls: type) -> DamperSpecification:
    return cast("DamperSpecification", specification_of(cls))
