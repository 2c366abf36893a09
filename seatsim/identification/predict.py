"""The force that a model predicts on a bench record."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.compilation.cached import compiled
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, run_bench
from seatsim.kernel.coil_current import simulate_current
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.registry import specification_of

Array = NDArray[np.float64]

FAST_ENOUGH = 400.0
"""Hz; at this rate and above every second row is the middle of a step."""
ROOM = 20.0
"""degC, where no temperature was recorded."""


class Bench(NamedTuple):
    """What the force on a bench depends on: the damper, its temperature factors, the coil's rates in 1/s.

        F = F_damper(x, v, i, T) + warming (T - T0),   di/dt = r (u - i),  r = rise where u > i, else fall

    warming: N/K by which the offset grows as the gas warms up from the factors' reference temperature T0.
    """

    damper: Any
    factors: TemperatureFactors
    rise: float = 130.0
    fall: float = 130.0
    warming: float = 0.0


class Drive(NamedTuple):
    """A record as the bench is driven by it: samples every half step, shape (2 n + 1,), and the force at steps.

    x [m] from the origin, v [m/s], current [A], temperature [degC], step [s]; force [N] has shape (n + 1,). Steps
    before the one `counted` only bring the damper into its state.
    """

    x: Array
    v: Array
    current: Array
    commanded: bool
    temperature: Array
    step: float
    force: Array
    counted: int = 0


def drive(record: BenchRecord, origin: float, every: bool) -> Drive:
    """Return the drive of a record: every row a step, or, unless `every`, each second one where the rows are close.

    origin: displacement in m that counts as x = 0.
    """
    x, v = record.displacement - origin, record.velocity
    warm = np.full(len(x), ROOM) if record.temperature is None else record.temperature
    rate = record.rate
    if not every and rate >= FAST_ENOUGH:
        odd = slice(0, len(x) - 1 + len(x) % 2)
        x, v, current, warm = (np.ascontiguousarray(y[odd]) for y in (x, v, record.current, warm))
        return Drive(x, v, current, record.commanded, warm, 2.0 / rate, record.force[odd][::2].copy())
    fixed = np.repeat(record.current, 2)[:-1] if record.commanded else _linear(record.current)
    return Drive(_cubic(x), _cubic(v), fixed, record.commanded, _linear(warm), 1.0 / rate, record.force.copy())


def _cubic(y: Array) -> Array:
    """Return samples and the values between them, of the cubic through the four nearest."""
    out = _linear(y)
    out[3:-3:2] = (9.0 * (y[1:-2] + y[2:-1]) - y[:-3] - y[3:]) / 16.0
    return out


def _linear(y: Array) -> Array:
    out = np.empty(2 * len(y) - 1)
    out[::2] = y
    out[1::2] = 0.5 * (y[1:] + y[:-1])
    return out


def predicted(bench: Bench, drive: Drive, most: int = MOST_PARTS, tolerance: float = TOLERANCE) -> Array:
    """Return the force in N at the drive's steps, shape (n + 1,); NaN from where the state ran away.

    A step is divided into at most `most` parts until its error, over the force, is below `tolerance`.
    """
    current = drive.current
    if drive.commanded:
        current = simulate_current(Coil(bench.rise, rate_fall=bench.fall), current, 0.5 * drive.step, current[0])
    out = np.full(len(drive.force), math.nan)
    run = compiled(run_bench, classes_of(bench.damper))
    state = specification_of(type(bench.damper)).initial
    given = (drive.x, drive.v, current, drive.temperature, state, drive.step, most, tolerance, out)
    run(bench.damper, bench.factors, *given)
    return out + bench.warming * (drive.temperature[::2] - bench.factors.reference)
