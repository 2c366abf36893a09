"""From a scenario and inputs to what the sensors of the rig say: the one way in which recorded rigs are simulated.

Whatever compares a simulation with a recording comes through here: replay, gap, data checks, diagnosis and the design
of experiments. A run of a recording becomes inputs by `seatsim.recordings.replay.recorded_inputs`.
"""

from __future__ import annotations

import dataclasses
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, UnivariateSpline

from seatsim.effects.base import ON_SEAT, acts_on
from seatsim.kernel.bench import simulate_current
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of
from seatsim.simulation.augment import (
    augment_coil,
    augment_damper,
    augment_factors,
    augment_temperature,
    read_sensors,
    select_in_loop,
    undo_reading,
)
from seatsim.simulation.damper_bench import bench_force
from seatsim.simulation.inputs import BenchInputs, RigInputs
from seatsim.simulation.simulate import simulate

FINER = 16
"""Parts of a row by which a log may be shifted, an even number: a sixteenth of 5 ms is far below any coil's lag."""


def _simulate_bench(scenario: Scenario, inputs: BenchInputs) -> dict[str, Array]:
    """Return the simulated `damper_force` and `coil_current` of a bench at the rows of its inputs, shape (N,) each.

    Displacement follows a quintic spline smoothed to within its stated noise, velocity its derivative or, where it is
    recorded, its own spline. The command (or the command voltage times its gain) is held from its row until the next
    and drives the coil; where only a coil current is recorded it drives the damper; where nothing is, the current is
    zero.

    Raises:
        InputError: an effect acts on a part that a bench does not have. RunError: the damper's state ran away.
    """
    effects, interval = scenario.effects, inputs.interval
    for effect in effects:
        if acts_on(type(effect), (*ON_SEAT, "plant", "frame_force")):
            name = name_of("effect", type(effect))
            raise InputError(f"{scenario.name}: a damper bench has no part on which {name} acts; remove it")
    # As they truly were, but for displacement and command.
    read = {name: getattr(inputs, name) for name in ("velocity", "coil_current", "damper_temperature")}
    stated = {name: values for name, values in read.items() if values is not None}
    undone: dict[str, Any] = {name: undo_reading(effects, each, name, interval) for name, each in stated.items()}
    true = inputs._replace(**undone)
    rows = interval * np.arange(len(true.displacement), dtype=np.float64)
    fine = np.arange(2 * len(rows) - 1, dtype=np.float64) * 0.5 * interval
    position, velocity = _undo_motion(effects, inputs, rows, fine)
    if true.velocity is not None:
        velocity = CubicSpline(rows, true.velocity)(fine)
    current = _coil_current(scenario, true, rows, fine)
    damper, state = augment_damper(scenario.damper.record, select_in_loop(effects)[0])
    temperature = augment_temperature(effects, 0.5 * interval, _temperature(scenario, true, rows, fine))
    factors = augment_factors(effects, scenario.damper.factors)
    force = bench_force(damper, position, velocity, current, temperature, interval, factors, state)
    return read_sensors(effects, interval, {"damper_force": force, "coil_current": current[::2]})


def _undo_motion(effects: tuple[object, ...], inputs: BenchInputs, rows: Array, fine: Array) -> tuple[Array, Array]:
    """Return displacement and velocity on the half-row grid as they truly were.

    What a sensor did is undone after the noise is smoothed away: both are linear, and smoothing takes a thousand times
    longer, so that it is done once for all candidate effects.
    """
    smooth = _follow_motion(inputs.interval, inputs.displacement.tobytes(), inputs.displacement_noise)
    read = smooth[0][::2]
    true = undo_reading(effects, read, "displacement", inputs.interval)
    if true is read:
        return smooth
    spline = CubicSpline(rows, true)
    return spline(fine), spline(fine, 1)


@lru_cache(maxsize=64)
def fit_motion(interval: float, content: bytes, noise: float) -> UnivariateSpline:
    """Return the quintic spline over time in s that passes a displacement within its noise, both in m.

    It is asked for by the bytes (`content`) of the array, which are kept, so that no run is smoothed twice.
    """
    values = np.frombuffer(content)
    return UnivariateSpline(np.arange(len(values)) * interval, values, k=5, s=len(values) * noise**2)


@lru_cache(maxsize=64)
def _follow_motion(interval: float, content: bytes, noise: float) -> tuple[Array, Array]:
    """Return displacement and velocity on the half-row grid; kept, since a diagnosis replays a run a thousand times."""
    spline = fit_motion(interval, content, noise)
    fine = np.arange(len(content) // 4 - 1, dtype=np.float64) * 0.5 * interval
    return spline(fine), spline.derivative()(fine)


def _coil_current(scenario: Scenario, true: BenchInputs, rows: Array, fine: Array) -> Array:
    """Return the coil current in A on the half-row grid."""
    if true.current_command is not None:
        command, parts = _undo_command(scenario.effects, true.current_command, "current_command", true.interval)
    elif true.command_voltage is not None and true.voltage_gain is not None:
        command, parts = _undo_command(scenario.effects, true.command_voltage, "command_voltage", true.interval)
        command = true.voltage_gain * command
    else:
        return np.zeros(len(fine)) if true.coil_current is None else np.interp(fine, rows, true.coil_current)
    coil = augment_coil(scenario.effects, scenario.coil)
    start = 0.0 if true.coil_current is None else true.coil_current[0]
    current = simulate_current(coil, np.clip(command, 0.0, coil.max_current), true.interval / parts, start)
    return current[:: parts // 2]


def _undo_command(effects: tuple[object, ...], logged: Array, channel: str, interval: float) -> tuple[Array, int]:
    """Return the true command or voltage, held from its row until the next, and how many values of it a row has.

    A log by another clock is shifted by parts of a row, so that the command changes within the rows.
    """
    held = np.repeat(logged, FINER)[: 1 - FINER]
    true = undo_reading(effects, held, channel, interval / FINER)
    return (np.repeat(logged, 2)[:-1], 2) if true is held else (true, FINER)


def _temperature(scenario: Scenario, true: BenchInputs, rows: Array, fine: Array) -> Array:
    """Return the damper's temperature in degC on the half-row grid."""
    if true.damper_temperature is not None:
        return np.interp(fine, rows, true.damper_temperature)
    fixed = scenario.temperature
    return np.full(len(fine), fixed.start if isinstance(fixed, Thermal) else fixed)


SEAT_OUTPUTS = ("frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current")
"""What the sensors of a seat say, in the order in which they are reported; those of a bench say the last two."""


def respond(scenario: Scenario, inputs: RigInputs) -> dict[str, Array]:
    """Return what the sensors of a rig say, by channel, shape (rows,) each in SI units.

    The rig starts at rest at x = 0, wherever `scenario.start` puts it, because that is how a recording starts. On a
    seat the step of the simulation is that of the inputs.

    Raises:
        InputError: the scenario does not fit the inputs, or has an effect that a bench has no part for.
        RunError: the solution grew beyond all bounds.
    """
    if isinstance(inputs, BenchInputs):
        return _simulate_bench(scenario, inputs)
    solver = scenario.solver._replace(step=inputs.floor.step)
    at_rest = dataclasses.replace(scenario, solver=solver, start=Start())
    history = simulate(at_rest, inputs.floor, inputs.forces)
    steps = round(inputs.interval / inputs.floor.step)
    return read_sensors(scenario.effects, inputs.interval, {name: history[name][::steps] for name in SEAT_OUTPUTS})
