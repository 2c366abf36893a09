"""Runs that are made again with one thing changed: half and twice of a number, or half the step."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from seatsim.cosimulation.damper import FmuDamper
from seatsim.effects.base import acts_on
from seatsim.excitations.base import Floor
from seatsim.metrics.motion import rms
from seatsim.metrics.table import Metric
from seatsim.scenario.numbers import LAW, is_permitted, list_numbers, set_number
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import specification_of
from seatsim.simulation.result import History
from seatsim.simulation.runs import measure_run
from seatsim.simulation.simulate import DEFAULT_SAMPLE_TIME, simulate

STRETCH = 20.0
"""Seconds from the start that are simulated."""
_FACTORS = (0.5, 2.0)
_DAMPING = "plant.suspension_damping"


class _Trial(NamedTuple):
    """A number that was changed, by its dotted key, its value, and the metrics of the run with it."""

    key: str
    value: float
    metrics: dict[str, Metric]


def try_changes(scenario: Scenario) -> list[_Trial]:
    """Return the first stretch of a run as it is, under no key, then with each change that is permitted and possible.

    Raises:
        RunError: the run as it is cannot be carried to its end.
    """
    floor = _begin(scenario.excitation.floor(scenario.solver.step, scenario.seed))
    found = [_Trial("", 0.0, measure_run(scenario, simulate(scenario, floor)))]
    for key, value in _list_changes(scenario):
        with suppress(InputError, RunError):
            changed = set_number(scenario, key, value)
            found.append(_Trial(key, value, measure_run(changed, simulate(changed, floor))))
    return found


def _list_changes(scenario: Scenario) -> Iterator[tuple[str, float]]:
    for key, value in list_numbers(scenario).items():
        if value and (key == _DAMPING or key.startswith(f"{LAW}.")):
            yield from ((key, f * value) for f in _FACTORS if is_permitted(scenario, key, f * value))


def _begin(floor: Floor) -> Floor:
    count = round(STRETCH / floor.step) + 1
    motion = floor._asdict()
    del motion["step"]
    return Floor(floor.step, **{name: part[:count] for name, part in motion.items() if part is not None})


_HALVED_STRETCH = 5.0
"""Seconds from the start that are simulated again, a small share of most runs."""
_CHANNELS = ("driver_acceleration", "suspension_displacement", "damper_force")


def measure_step_error(scenario: Scenario, history: History, carry_all_effects: bool | None = False) -> float | None:
    """Return the largest relative change of an output as the step of the integration is halved.

        max over channels of rms(y(h) - y(h/2)) / rms(y(h/2)),  over the first `_HALVED_STRETCH` seconds

    The floor between two samples, which the simulation takes as linear, and the law's sample time stay as they are.

    Args:
        scenario: of the run.
        history: its channels with the step h that the scenario states.
        carry_all_effects: as for `simulate`, and as it was for this run, whose compiled loop is then used again.

    Returns:
        The change, or None where halving the step changes the question: a damper that is an FMU has a step of its own,
        and a random force on the frame is another one.
    """
    effects = (type(effect) for effect in scenario.effects)
    if isinstance(scenario.damper.record, FmuDamper) or any(acts_on(cls, ("frame_force",)) for cls in effects):
        return None
    step = scenario.solver.step
    floor = _halve_step(scenario.excitation.floor(step, scenario.seed), round(_HALVED_STRETCH / step) + 1)
    finer = simulate(_with_half_step(scenario), floor, carry_all_effects=carry_all_effects)
    count = len(finer["time"][::2])
    changes = [_compare(history[name][:count], finer[name][::2]) for name in _CHANNELS]
    return max(changes)


def _with_half_step(scenario: Scenario) -> Scenario:
    """Return a scenario with half the step, whose law is sampled at the same moments as before."""
    step, control = scenario.solver.step, scenario.control
    if control is not None and control.sample_time is None and not specification_of(type(control.law)).replays:
        control = dataclasses.replace(control, sample_time=max(DEFAULT_SAMPLE_TIME, step))
    return dataclasses.replace(scenario, solver=scenario.solver._replace(step=0.5 * step), control=control)


def _halve_step(floor: Floor, count: int) -> Floor:
    """Return the first samples of a floor with one more between each two of them."""

    def interpolate(values: Array) -> Array:
        rows = np.arange(len(values[:count]), dtype=np.float64)
        return np.interp(np.arange(2 * len(rows) - 1) / 2, rows, values[:count])

    acceleration, velocity, displacement = map(interpolate, (floor.acceleration, floor.velocity, floor.displacement))
    # A command holds until the next row.
    command = None if floor.command is None else np.repeat(floor.command[:count], 2)[:-1]
    current, temperature = (
        None if values is None else interpolate(values) for values in (floor.coil_current, floor.temperature)
    )
    return Floor(0.5 * floor.step, acceleration, velocity, displacement, command, current, temperature)


def _compare(coarse: Array, fine: Array) -> float:
    size = rms(fine)
    return rms(coarse - fine) / size if size > 0 else 0.0
