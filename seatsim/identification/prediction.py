"""The force that a model predicts on a bench record, also on one whose owner smoothed it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.dampers.base import DAMPERS
from seatsim.identification.damper_record import DamperRecord
from seatsim.kernel.augmented import classes_of
from seatsim.kernel.bench import MOST_PARTS, TOLERANCE, run_bench, simulate_current
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array

_FAST_ENOUGH = 400.0
"""Hz; at this rate and above every second row is the middle of a step."""
_ROOM_TEMPERATURE = 20.0
"""degC, where no temperature was recorded."""


class BenchModel(NamedTuple):
    """What the force on a bench depends on: the damper, its temperature factors, the coil's rates in 1/s.

        F = F_damper(x, v, i, T) + g (T - T0),   di/dt = r (u - i),  r = rise where u > i, else fall

    offset_per_kelvin: g in N/K, by which the offset grows as the gas warms up from the factors' reference temperature
    T0.
    """

    damper: DamperRecord
    factors: TemperatureFactors
    rise: float = 130.0
    fall: float = 130.0
    offset_per_kelvin: float = 0.0


class RecordInputs(NamedTuple):
    """A record as it drives the bench: samples every half step, shape (2 n + 1,), and the measured force at steps.

    x [m] from the origin, v [m/s], current [A] (a command for the coil where `commanded`), temperature [degC], step
    [s]; force [N] has shape (n + 1,). Steps before the one `counted` only bring the damper into its state.
    """

    x: Array
    v: Array
    current: Array
    commanded: bool
    temperature: Array
    step: float
    force: Array
    counted: int = 0


def prepare_inputs(record: BenchRecord, origin: float, every: bool) -> RecordInputs:
    """Return a record as inputs: every row a step, or, unless `every`, each second one where the rows are close.

    origin: displacement in m that counts as x = 0.
    """
    x, v = record.displacement - origin, record.velocity
    warm = np.full(len(x), _ROOM_TEMPERATURE) if record.temperature is None else record.temperature
    rate = record.rate
    if not every and rate >= _FAST_ENOUGH:
        odd = slice(0, len(x) - 1 + len(x) % 2)
        x, v, current, warm = (np.ascontiguousarray(y[odd]) for y in (x, v, record.current, warm))
        return RecordInputs(x, v, current, record.commanded, warm, 2.0 / rate, record.force[odd][::2].copy())
    # A command holds until its next row; a current that was measured goes straight on to it.
    current = np.repeat(record.current, 2)[:-1] if record.commanded else _halve_linearly(record.current)
    x, v, warm = _halve_cubically(x), _halve_cubically(v), _halve_linearly(warm)
    return RecordInputs(x, v, current, record.commanded, warm, 1.0 / rate, record.force.copy())


def _halve_cubically(y: Array) -> Array:
    """Return samples and the values between them, of the cubic through the four nearest."""
    out = _halve_linearly(y)
    out[3:-3:2] = (9.0 * (y[1:-2] + y[2:-1]) - y[:-3] - y[3:]) / 16.0
    return out


def _halve_linearly(y: Array) -> Array:
    """Return samples and the means between them."""
    out = np.empty(2 * len(y) - 1)
    out[::2] = y
    out[1::2] = 0.5 * (y[1:] + y[:-1])
    return out


def predict_force(
    bench: BenchModel, inputs: RecordInputs, most: int = MOST_PARTS, tolerance: float = TOLERANCE
) -> Array:
    """Return the force in N at the inputs' steps, shape (n + 1,); NaN from where the state ran away.

    A step is divided into at most `most` parts until its error, over the force, is below `tolerance`.
    """
    current = inputs.current
    if inputs.commanded:
        current = simulate_current(Coil(bench.rise, rate_fall=bench.fall), current, 0.5 * inputs.step, current[0])
    out = np.full(len(inputs.force), math.nan)
    run = compiled(run_bench, classes_of(bench.damper))
    state = DAMPERS.specification_of(type(bench.damper)).initial
    given = (inputs.x, inputs.v, current, inputs.temperature, state, inputs.step, most, tolerance, out)
    run(bench.damper, bench.factors, *given)
    return out + bench.offset_per_kelvin * (inputs.temperature[::2] - bench.factors.reference)


_RECOVERED = 0.85
"""Frequency up to which motion is sharpened, over the first one that a moving average removes altogether."""


def smooth(y: Array, rows: int) -> Array:
    """Return the centred moving average of y, shape (N,), over `rows` rows; ends are held."""
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(y, rows, mode="nearest"), dtype=float) if rows > 1 else y


def sharpen(record: BenchRecord, rows: int) -> BenchRecord:
    """Return the record with its motion as it was before a centred moving average over `rows` rows.

    Divided by the average's response, `sin(pi f n / r) / (n sin(pi f / r))` at the frequency f and the rate r, up to
    85 % of its first zero r / n; nothing is left above. The record begins and ends at rest, else its ends are wrong.
    The force stays as it is.
    """
    if rows < 2:
        return record
    x, rate = record.displacement, record.rate
    # Mirrored, so that the periodic continuation that a Fourier transform implies has no jump.
    mirrored = np.concatenate([x, x[::-1]])
    frequency = np.fft.rfftfreq(len(mirrored), 1.0 / rate)
    with np.errstate(invalid="ignore", divide="ignore"):
        response = np.sin(np.pi * frequency * rows / rate) / (rows * np.sin(np.pi * frequency / rate))
    response[0] = 1.0  # sin(0) / sin(0) was not a number
    kept = frequency < _RECOVERED * rate / rows
    spectrum = np.where(kept, np.fft.rfft(mirrored) / np.where(kept, response, 1.0), 0.0)
    sharp = np.fft.irfft(spectrum, len(mirrored))[: len(x)]
    return record._replace(displacement=sharp, velocity=np.gradient(sharp, 1.0 / rate))
