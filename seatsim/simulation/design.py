"""Design of a scenario's law: for the nominal rig, the floors that it is designed for, and the travel that it has."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial

from seatsim.rig.control import CompiledLaw, FloorRecord, Law, prepare_law
from seatsim.rig.designs import SynthesisedLaw
from seatsim.rig.plant import Plant
from seatsim.scenario.scenario import Control, Scenario
from seatsim.schema.errors import InputError, SynthesisError

_PeakTravel = Callable[[Scenario], float]
"""Function that simulates a scenario and returns the largest displacement of its suspension in m."""

_MARGIN = 0.1
"""Share of the travel that the design leaves free: other draws of a floor of a minute reach some 10 % further."""
_WEIGHTS = (1.0, 300.0)
"""Least and largest weight of the travel in 1/s^2 that are tried: from hardly any to a seat that hardly moves."""
_HALVINGS = 5
"""Halvings of the interval of the weight's logarithm: the weight is found to a fifth, the travel to 3 % or so."""


def design_law(
    scenario: Scenario, plant: Plant, control: Control, period: float, peak_travel: _PeakTravel
) -> CompiledLaw:
    """Return the compiled form of a scenario's law, sampled every `period` seconds.

    It is designed for the nominal plant and coil, since its designer knows no effects.
    """
    law = settle_travel(scenario, control, peak_travel)
    return prepare_law(law, plant, scenario.coil, period, partial(record_floors, scenario, control))


def record_floors(scenario: Scenario, control: Control) -> list[FloorRecord]:
    """Return the floors that a law is designed for, in another random draw than that on which it runs."""
    step = scenario.solver.step
    floors = [each.excitation.floor(step, each.seed) for each in _list_design_runs(scenario, control)]
    return [FloorRecord(step, floor.acceleration) for floor in floors]


def settle_travel(scenario: Scenario, control: Control, peak_travel: _PeakTravel) -> Law:
    """Return the law with its travel weight, which is found by simulation where it is stated as `limit`.

    It is the least weight whose seat, with the forces that the damper can give, keeps nine tenths of its travel on
    every floor of the design. The peak is taken to fall as the weight rises.

    Raises:
        InputError: the seat states no travel.
        SynthesisError: no weight keeps the seat within its travel.
    """
    law = control.law
    if not isinstance(law, SynthesisedLaw) or not law.is_limited_by_travel:
        return law
    return law.with_travel_weight(_find_weight(tuple(_list_design_runs(scenario, control)), peak_travel))


def _list_design_runs(scenario: Scenario, control: Control) -> Sequence[Scenario]:
    """Return the nominal runs of a design, one on each of its floors; equal where the design is the same."""
    bare = replace(scenario, name="", effects=(), checks=(), label={}, source=None, seed=scenario.seed + 1)
    return [replace(bare, excitation=floor) for floor in control.floors or (scenario.excitation,)]


@lru_cache(maxsize=64)
def _find_weight(runs: tuple[Scenario, ...], peak_travel: _PeakTravel) -> float:
    stops = runs[0].plant.end_stops if runs[0].plant else None
    if stops is None:
        raise InputError("weights.travel: limit needs the travel between the end stops; state plant.travel")
    permitted = (1.0 - _MARGIN) * min(abs(stop) for stop in stops)

    def keeps(weight: float) -> bool:
        return all(peak_travel(_with_weight(run, weight)) <= permitted for run in runs)

    low, high = map(math.log, _WEIGHTS)
    if keeps(_WEIGHTS[0]):
        return _WEIGHTS[0]
    if not keeps(_WEIGHTS[1]):
        raise SynthesisError(
            f"no weight of the travel up to {_WEIGHTS[1]:g} 1/s^2 keeps the seat within {1000 * permitted:.3g} mm, nine"
            " tenths of its travel; the floor is too rough, or the damper too weak"
        )
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if keeps(math.exp(middle)) else (middle, high)
    return math.exp(high)


def _with_weight(run: Scenario, weight: float) -> Scenario:
    control = run.control
    if control is None or not isinstance(control.law, SynthesisedLaw):
        return run
    return replace(run, control=replace(control, law=control.law.with_travel_weight(weight)))
