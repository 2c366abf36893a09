"""A class of the user's own tried for an instant on an example, so that what is wrong with it is said before a run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from seatsim.compilation.reasons import explain
from seatsim.dampers.base import DAMPERS
from seatsim.effects.base import EFFECTS, off
from seatsim.rig.temperature import TemperatureScaling
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError, SeatsimError
from seatsim.schema.fields import bounds, field_names
from seatsim.simulation.result import Run
from seatsim.simulation.runs import run_one

EXAMPLE = "em5"
SECONDS = 0.1
TRIED = (0.01, 0.1, 0.5)
"""Displacement [m], velocity [m/s] and current [A] at which a damper is asked for its force."""


def try_class(kind: str, name: str, cls: type) -> list[str]:
    """Return what is doubtful about a class after a tenth of a second on the seat of an example.

    Raises:
        InputError: it cannot be compiled or simulated, or does not do what it promises.
    """
    try:
        return list(TRIALS[kind](name, cls)) if kind in TRIALS else []
    except SeatsimError as error:
        raise InputError(f"{kind} {name}: {error}") from error
    except Exception as error:  # the code of somebody else may raise anything
        raise InputError(f"{kind} {name}: {explain(error)}") from error


def _try_damper(name: str, cls: type) -> Iterator[str]:
    values = {field: _choose_value(cls, field) for field in field_names(cls)}
    record: Any = cls(**values)
    state = DAMPERS.specification_of(cls).initial
    scaling = TemperatureScaling()
    if not np.isfinite(float(record.force(*TRIED, scaling, state))):
        raise InputError(f"force{TRIED} is no finite number")
    if state:
        rates = record.rates(*TRIED, scaling, state)
        if not isinstance(rates, tuple) or len(rates) != len(state):
            raise InputError(f"rates returns {rates!r}; permitted: a tuple of {len(state)}, such as (0.0,)")
    _simulate({"damper": {"model": name, "parameters": values}})
    return iter(())


def _try_law(name: str, cls: type) -> Iterator[str]:
    values = {field: _choose_value(cls, field) for field in field_names(cls)}
    _simulate({"controller": {"law": name, **values}})
    return iter(())


def _try_effect(name: str, cls: type) -> Iterator[str]:
    specification = EFFECTS.specification_of(cls)
    if not specification.forms:
        yield f"effect {name}: without forms, no diagnosis tries it"
    if specification.by_channel:
        return
    plain = _simulate({"effects": []})
    at_rest = _simulate({"effects": [_state(name, off(cls)._asdict())]})
    if not all(np.allclose(plain[channel], at_rest[channel]) for channel in ("driver_acceleration", "damper_force")):
        raise InputError("changes the rig where it is off: where all parameters are zero, or those of off=...")
    for form in specification.forms:
        _simulate({"effects": [_state(name, {**off(cls)._asdict(), **form.fixed, **form.free})]})


def _state(name: str, values: dict[str, Any]) -> dict[str, object]:
    return {"effect": name, "parameters": values}


def _choose_value(cls: Any, field: str) -> object:
    """Return the default of a field, or a value between its bounds."""
    if field in cls._field_defaults:
        return cls._field_defaults[field]
    low, high = bounds(cls, field)
    return 0.5 * (low + high) if np.isfinite(low + high) else 1.0


def _simulate(settings: dict[str, object]) -> Run:
    return run_one(load(EXAMPLE, {**settings, "variants": {}, "excitation.duration": SECONDS})[0])


TRIALS = {"damper": _try_damper, "law": _try_law, "effect": _try_effect}
