"""Replay of a damper bench: recorded motion and command in, force and coil current out."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, UnivariateSpline

from seatsim.effects.base import ON_SEAT, acts_on
from seatsim.kernel.coil_current import simulate_current
from seatsim.recordings.recording import Recording
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of
from seatsim.simulation.augment import changed, damper_with, in_loop, readings, undone
from seatsim.simulation.damper_bench import bench_force

Array = NDArray[Any]


def replay_bench(scenario: Scenario, recording: Recording, run: str) -> dict[str, Array]:
    """Return the simulated `damper_force` and `coil_current` of a bench run at its rows.

    Displacement follows a quintic spline smoothed to within its stated noise, velocity its derivative or, where it is
    recorded, its own spline. The command (or `command_voltage` times the recording's gain) is held from its row until
    the next and drives the coil; where only `coil_current` is recorded it drives the damper; where nothing is, the
    current is zero.
    """
    effects = scenario.effects
    for effect in effects:
        if acts_on(type(effect), (*ON_SEAT, "plant", "frame_force")):
            name = name_of("effect", type(effect))
            raise InputError(f"{scenario.name}: a damper bench has no part on which {name} acts; remove it")
    interval = 1.0 / recording.header.sample_rate
    table = {name: undone(effects, values, name, interval) for name, values in recording.table(run).items()}
    rows = np.arange(len(table["displacement"])) * interval
    fine = np.arange(2 * len(rows) - 1) * 0.5 * interval
    position = _smooth(interval, table["displacement"].tobytes(), recording.channels["displacement"].noise_rms)
    velocity = CubicSpline(rows, table["velocity"])(fine) if "velocity" in table else position.derivative()(fine)
    current = _current(changed(effects, "coil", scenario.coil), table, recording.voltage_gain, rows, fine)
    damper, state = damper_with(scenario.damper.record, in_loop(effects)[0])
    temperature = changed(effects, "temperature", _temperature(scenario, table, rows, fine), 0.5 * interval)
    factors = changed(effects, "factors", scenario.damper.factors)
    force = bench_force(damper, position(fine), velocity, current, temperature, interval, factors, state)
    return readings(effects, interval, {"damper_force": force, "coil_current": current[::2]})


@lru_cache(maxsize=64)
def _smooth(interval: float, content: bytes, noise: float) -> UnivariateSpline:
    """Return the spline through a channel, whose `content` is kept so that no run is smoothed twice."""
    values = np.frombuffer(content)
    return UnivariateSpline(np.arange(len(values)) * interval, values, k=5, s=len(values) * noise**2)


def _current(coil: Coil, table: Mapping[str, Array], gain: float | None, rows: Array, fine: Array) -> Array:
    """Return the coil current on the half-row grid."""
    command = table.get("current_command")
    if command is None and gain is not None and "command_voltage" in table:
        command = gain * table["command_voltage"]
    if command is None:
        return np.interp(fine, rows, table["coil_current"]) if "coil_current" in table else np.zeros(len(fine))
    held = np.searchsorted(rows, fine - coil.delay + 1e-9 * rows[1], side="right") - 1
    start = table["coil_current"][0] if "coil_current" in table else 0.0
    wanted = np.where(held < 0, start, np.clip(command, 0.0, coil.max_current)[np.maximum(held, 0)])
    return simulate_current(coil, wanted, fine[1], start)


def _temperature(scenario: Scenario, table: Mapping[str, Array], rows: Array, fine: Array) -> Array:
    if "damper_temperature" in table:
        return np.interp(fine, rows, table["damper_temperature"])
    fixed = scenario.temperature
    return np.full(len(fine), fixed.start if isinstance(fixed, Thermal) else fixed)
