"""Steady cycles of a record, and the response of a force or a current to steps of the current."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.metrics.motion import ratio
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, Unwritten
from seatsim.simulation.damper_bench import SineTest

LEAST_RANGE = 0.02
"""A; a current that varies less is constant."""
_BAND = 0.2
"""Half the width, over the amplitude, of the band about mid-stroke that a passage has to cross from side to side."""
_ALIKE = 0.03
"""Largest difference of a steady cycle's amplitude and period from their median, relative."""
_CENTRED = 0.05
"""Largest distance of the middle of a steady cycle from the median of the middles, over the amplitude."""
_LEAST_STEADY = 3
"""Steady cycles that make a record cyclic; two where there are no others."""
_SAMPLES = (64, 2000)
"""Least and most samples of a resampled cycle."""


class Cycle(NamedTuple):
    """One cycle of a record: its ends as rows (with fractions), amplitude and mid-stroke in m."""

    first: float
    last: float
    amplitude: float
    middle: float

    @property
    def rows(self) -> slice:
        """The rows inside."""
        return slice(int(np.ceil(self.first)), int(self.last) + 1)

    @property
    def length(self) -> float:
        """Number of rows, with fractions."""
        return self.last - self.first


def find_cycles(displacement: Array) -> list[Cycle]:
    """Return the cycles of a displacement, shape (N,), from one upward passage of mid-stroke to the next.

    Mid-stroke is halfway between the 1st and the 99th percentile. A passage leads from below a band about it to
    above, so that noise makes none; its instant is where the straight line through its rows meets mid-stroke.
    """
    low, high = (float(q) for q in np.percentile(displacement, (1, 99)))
    centre, amplitude = 0.5 * (low + high), 0.5 * (high - low)
    if amplitude <= 0.0:
        return []
    above, below = displacement > centre + _BAND * amplitude, displacement < centre - _BAND * amplitude
    side = above.astype(np.int8) - below
    outside = np.flatnonzero(side)
    upward = np.flatnonzero((side[outside][:-1] < 0) & (side[outside][1:] > 0))
    instants = [_passage(displacement, outside[k], outside[k + 1], centre) for k in upward]
    return [_cycle(displacement, a, b) for a, b in pairwise(instants)]


def _passage(x: Array, first: int, last: int, centre: float) -> float:
    part, middle = x[first : last + 1], 0.5 * (first + last)
    rows = np.arange(first, last + 1) - middle
    slope = float(rows @ part) / float(rows @ rows)
    return float(np.clip(middle + (centre - np.mean(part)) / slope, first, last)) if slope > 0.0 else middle


def _cycle(x: Array, first: float, last: float) -> Cycle:
    inside = x[int(first) : int(np.ceil(last)) + 1]
    low, high = float(np.min(inside)), float(np.max(inside))
    return Cycle(first, last, 0.5 * (high - low), 0.5 * (high + low))


def select_steady_cycles(cycles: Sequence[Cycle]) -> list[Cycle]:
    """Return the cycles whose amplitude, period and mid-stroke agree with their medians: no ring-up, no ring-down.

    Empty where they are fewer than half of all, or fewer than three (two, where these are all): such a record is not
    cyclic.
    """
    if not cycles:
        return []
    table = np.array([(cycle.amplitude, cycle.length, cycle.middle) for cycle in cycles])
    amplitude, length, middle = np.median(table, axis=0)
    alike = np.abs(table[:, 0] - amplitude) <= _ALIKE * amplitude
    alike &= np.abs(table[:, 1] - length) <= _ALIKE * length
    alike &= np.abs(table[:, 2] - middle) <= _CENTRED * amplitude
    steady = [cycle for cycle, kept in zip(cycles, alike, strict=True) if kept]
    enough = len(steady) >= min(_LEAST_STEADY, max(2, len(cycles)))
    return steady if enough and 2 * len(steady) >= len(cycles) else []


def resample_loops(record: BenchRecord, cycles: Sequence[Cycle], drift: float) -> list[SineTest]:
    """Return cycles of a record as loops of equally many samples, both ends included, by linear interpolation.

    A sample is the mean of the rows that it stands for, and the slope `drift` in N/s of the zero (see `find_drift`) is
    taken from the force of each loop about its middle, so that the loop closes.
    """
    from scipy.ndimage import uniform_filter1d

    least, most = _SAMPLES
    length = float(np.median([cycle.length for cycle in cycles]))
    samples = min(most, max(least, 2 * round(0.5 * length)))
    rows = np.arange(len(record.force), dtype=float)
    width = 2 * int(0.5 * length / samples) + 1
    at = np.linspace([cycle.first for cycle in cycles], [cycle.last for cycle in cycles], samples + 1, axis=1)
    time = (at - at[:, :1]) / record.rate
    measured = (record.displacement, record.velocity, record.force)
    x, v, force = (np.interp(at, rows, uniform_filter1d(y, width)) for y in measured)
    force -= drift * (time - 0.5 * time[:, -1:])
    return [SineTest(*parts) for parts in zip(time, x, v, force, strict=True)]


def find_drift(record: BenchRecord, cycles: Sequence[Cycle]) -> float:
    """Return the slope in N/s of the mean forces of cycles over time, 0 for a single cycle."""
    if len(cycles) < 2:
        return 0.0
    middles = [0.5 * (cycle.first + cycle.last) / record.rate for cycle in cycles]
    return float(np.polyfit(middles, [np.mean(record.force[cycle.rows]) for cycle in cycles], 1)[0])


def average_loops(loops: Sequence[SineTest]) -> SineTest:
    """Return the mean of loops of equally many samples, phase by phase."""
    return SineTest(*(np.mean([loop[part] for loop in loops], axis=0) for part in range(4)))


SHARES = (0.05, 0.90, 0.95)
"""Shares of the change whose instants are stated."""
_RESAMPLES = 200
"""Draws of the steps from which the deviation of t95 is taken: it is then known to some 5 %."""
_SETTLED_BY = 0.1
"""Largest difference of the curve's last but one fifth from 1, for a response that has settled."""


_Seconds = Annotated[float, Form(unit="s")]
_Amperes = Annotated[float, Form(unit="A")]
_Rate = Annotated[float, Form(unit="per_s")]
_Speed = Annotated[float, Form(unit="m_s")]


class Response(NamedTuple):
    """How a force follows steps of the current between two levels; seconds from the step, 1/s, A.

    t5, t90, t95: time to 5, 90 and 95 % of the change. The rates are those of a first-order lag, `1 - exp(-r t)`:

        rate_95 = ln 20 / t95,   rate_90 = ln 10 / t90           without a delay
        rate = ln 19 / (t95 - t5),   delay = t5 - ln(20/19) / rate   behind a delay

    t95_sd: standard deviation of t95 by resampling the steps. current_t95: of the current itself, where it was measured
    or is simulated. speed: in m/s, where it is constant. method: how the motion was taken out of the force, or empty
    where the response cannot be determined; then `note` says why. time, share: the curve, shape (N,). direction: of the
    motion, rebound, compression or both. current_t10: as current_t95, of 10 %. current_overshoot: over its change.
    """

    record: str
    before: _Amperes
    after: _Amperes
    steps: int
    method: str
    note: str = ""
    t5: _Seconds = math.nan
    t90: _Seconds = math.nan
    t95: _Seconds = math.nan
    t95_sd: _Seconds = math.nan
    rate_90: _Rate = math.nan
    rate_95: _Rate = math.nan
    rate: _Rate = math.nan
    delay: _Seconds = math.nan
    current_t95: _Seconds = math.nan
    speed: _Speed = math.nan
    time: Unwritten[Array | None] = None
    share: Unwritten[Array | None] = None
    direction: Unwritten[str] = "both"
    current_t10: Unwritten[float] = math.nan
    current_overshoot: Unwritten[float] = math.nan

    @property
    def rises(self) -> bool:
        """Whether the current rises."""
        return self.after > self.before


class StepEnsemble(NamedTuple):
    """Forces about some steps, shape (steps, N), row by row from `before_rows` rows before each step.

    off, on: the force that the same motion has at the current before, and at the current after the step. instants:
    seconds from the step to row `before_rows`, of each.
    """

    force: Array
    off: Array
    on: Array
    instants: Array
    before_rows: int
    rate: float


def estimate_response(ensemble: StepEnsemble, blank: Response, window: int = 1) -> Response:
    """Return the response of an ensemble: the share of the new level that fits all steps best, at each instant.

        s(t) = sum (F - F_off) (F_on - F_off) / sum (F_on - F_off)^2

    over the steps and a `window` of rows, then counted from its mean before the step and to that of its end, so that a
    step that follows another before the force has settled does no harm to a first-order lag.
    """
    wanted = ensemble.on - ensemble.off
    top, bottom = (ensemble.force - ensemble.off) * wanted, wanted * wanted
    time = (np.arange(top.shape[1]) - ensemble.before_rows) / ensemble.rate + float(np.mean(ensemble.instants))
    share, end = _curve(top.sum(axis=0), bottom.sum(axis=0), time, window)
    if not abs(end - 1.0) <= _SETTLED_BY:
        return blank._replace(method="", note=f"the force has not settled within {1e3 * time[-1]:.0f} ms of a step")
    t5, t90, t95 = (find_crossing(time, share, level) for level in SHARES)
    rate = math.log(19.0) / (t95 - t5) if t95 > t5 else math.nan
    return blank._replace(
        t5=t5, t90=t90, t95=t95, t95_sd=_deviation(top, bottom, time, window),
        rate_90=ratio(math.log(10.0), t90), rate_95=ratio(math.log(20.0), t95), rate=rate,
        delay=t5 - math.log(20.0 / 19.0) / rate, time=time, share=share,
    )  # fmt: skip


def find_crossing(time: Array, share: Array, level: float) -> float:
    """Return the first instant from 0 on at which a curve reaches a level, interpolated; NaN where it never does."""
    after = np.flatnonzero((time >= 0.0) & (share >= level))
    if not after.size:
        return math.nan
    k = int(after[0])
    if k == 0 or share[k - 1] >= level or time[k - 1] < 0.0:
        return float(time[k])
    return float(np.interp(level, share[k - 1 : k + 1], time[k - 1 : k + 1]))


def _curve(top: Array, bottom: Array, time: Array, window: int) -> tuple[Array, float]:
    """Return the normalised curve, and its last but one fifth over its last."""
    ones = np.ones(window)
    share = np.convolve(top, ones, "same") / np.maximum(np.convolve(bottom, ones, "same"), 1e-300)
    start = float(np.mean(share[time < 0.0]))
    fifth = max(1, len(time[time > 0.0]) // 5)
    span = float(np.mean(share[-fifth:])) - start
    if span <= 0.0:
        return share, math.nan
    curve = np.asarray((share - start) / span, dtype=float)
    return curve, float(np.mean(curve[-2 * fifth : -fifth]))


def _deviation(top: Array, bottom: Array, time: Array, window: int) -> float:
    """Return the standard deviation of t95 over resampled steps; NaN for fewer than three steps."""
    steps = len(top)
    if steps < 3:
        return math.nan
    draws = np.random.default_rng(0).integers(0, steps, (_RESAMPLES, steps))
    counts = np.stack([np.bincount(draw, minlength=steps) for draw in draws]).astype(float)
    curves = (_curve(a, b, time, window)[0] for a, b in zip(counts @ top, counts @ bottom, strict=True))
    times = [find_crossing(time, curve, SHARES[-1]) for curve in curves]
    return float(np.std([t for t in times if math.isfinite(t)])) if any(map(math.isfinite, times)) else math.nan
