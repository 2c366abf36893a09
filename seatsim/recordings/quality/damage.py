"""What the values of a channel look like, whatever they mean: plateaus, flat tops, smallest step, white noise."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.quality.issue import Issue, RunUnderTest, doubt
from seatsim.recordings.recording import COMMANDS
from seatsim.schema.arrays import Array

_WINDOW, _FEWEST, _LEAST_WINDOWS = 0.5, 50, 4
"""Seconds of a window in which noise is measured, its least rows, and least windows of a run."""
_PILED = 3.0
"""Ratio of the rows at an extreme to those beside it from which they are piled up there."""
_FLICKER = 0.5
"""Least share of rows that differ from the row before where noise exceeds the resolution: white noise of one step gives
three quarters."""
_SPIKE, _AROUND, _ALONE = 8.0, 25, 4.0
"""A spike bends so many times as much as usual, and so many times as much as anything within so many rows."""
_LEAST_FOR_SPIKES = 5
"""Rows below which nothing is a spike."""
NOTABLE = 0.5
"""Size of a spike that is said, in standard deviations of its channel."""
_MOST_CANDIDATES = 20_000
"""Rows that bend much, above which a channel is rough and has no spikes."""
_DROPOUT, _JUMP = 10, 5.0
"""Least rows of a dropout, and the jump before or after it, in usual steps between rows."""
REGULAR = 0.8
"""Share of stretches of one length above which a channel is held, and not at rest here and there."""
_SMOOTH = 0.7
"""Ratio of the noise in fourth to that in third differences below which it is not white: a filter took it."""
SILENT = 3e-5
"""Noise as a share of the swing below which no sensor is."""
_COARSE, _LEVELLED = 1.2, 0.3
"""Share of its step below which noise is hidden by the resolution; ratio of small to usual gaps of what has steps."""
MOST_ROWS = 200_000
"""Rows that the slower checks look at."""


class Level(NamedTuple):
    """RMS of a channel's noise from third and fourth differences, and from fourth ones in calm and lively windows."""

    third: float
    fourth: float
    calm: float
    lively: float


def plateaus(values: Array) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return length and first row of each stretch of equal values."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    return np.diff(np.append(starts, len(values))), starts


def flat_tops(values: Array) -> Iterator[tuple[float, int]]:
    """Yield each extreme other than zero at which far more rows stand than in the 2 % of the range beside it.

    Coarse values are compared with the next level: a sine has 2.4 times as many rows at the last one.
    """
    lengths, starts = plateaus(values)
    # With so many stretches most are one row long, and their median need not be sought.
    usual = 1.0 if 3 * len(starts) > 2 * len(values) else float(np.median(lengths))
    for extreme in (float(np.max(values)), float(np.min(values))):
        at = values == extreme
        rows = int(np.sum(at))
        if rows < 5 * usual:
            continue
        near = max(0.02 * float(np.ptp(values)), 1.5 * quantum(values))
        beside = int(np.sum(np.abs(values - extreme) <= near)) - rows
        if extreme != 0.0 and rows >= _PILED * beside and np.max(lengths[at[starts]]) >= 3 * usual:
            yield extreme, rows


def quantum(values: Array) -> float:
    """Return the smallest step between two values."""
    return float(np.min(np.diff(np.unique(values)), initial=np.inf))


def _flickers(values: Array, rate: float) -> bool:
    """Say whether values change from row to row, as noise makes them, in the calmest fifth of windows too.

    The longest stretch of equal values is left out, as a sensor may be stuck there.
    """
    lengths, starts = plateaus(values)
    longest = int(np.argmax(lengths))
    rest = np.delete(values, slice(starts[longest], starts[longest] + lengths[longest]))
    rows = max(round(_WINDOW * rate), _FEWEST)
    pieces = rest[: len(rest) // rows * rows].reshape(-1, rows)
    spread = np.std(pieces, axis=1)
    calm = pieces[spread <= np.quantile(spread, 0.2)] if len(pieces) else pieces
    return len(calm) > 0 and float(np.mean(np.diff(calm, axis=1) != 0.0)) > _FLICKER


def is_fine(run: RunUnderTest, channel: str) -> bool:
    """Say whether the noise of a channel, stated and seen, exceeds its resolution: it then changes at each row."""
    values = run.table[channel]
    return run.noise(channel) > quantum(values) and _flickers(values, run.rate)


def measure_level(values: Array, rate: float) -> Level:
    """Return the level in the quietest fifth of windows, infinite where there are too few."""
    rows = max(round(_WINDOW * rate), _FEWEST)
    windows = len(values) // rows
    if windows < _LEAST_WINDOWS:
        return Level(np.inf, np.inf, np.inf, np.inf)
    pieces = values[: windows * rows].reshape(windows, rows)
    third, fourth = (
        np.median(np.abs(np.diff(pieces, n, axis=1)), axis=1) / (0.6745 * norm)
        for n, norm in ((3, 20**0.5), (4, 70**0.5))
    )
    quiet, spread = fourth <= np.quantile(fourth, 0.2), np.std(pieces, axis=1)
    calm, lively = spread <= np.quantile(spread, 0.2), spread >= np.quantile(spread, 0.8)
    return Level(*(float(np.mean(each)) for each in (third[quiet], fourth[quiet], fourth[calm], fourth[lively])))


class Doubter(NamedTuple):
    """What says the doubts about one channel, with its rate in Hz where that is known."""

    channel: str
    rate: float | None

    def say(self, name: str, **figures: object) -> Issue:
        """Return a doubt: a finding with its figures."""
        return doubt(name, self.channel, **figures)

    def at(self, row: int) -> str:
        """Return where a row is."""
        return f"row {row}" if self.rate is None else f"{row / self.rate:.4g} s"


def doubt_shape(doubter: Doubter, values: Array, lengths: NDArray[np.int_]) -> Iterator[Issue]:
    """Yield clipping, spikes, held values and the floor of a channel that varies."""
    for extreme, rows in flat_tops(values):
        yield doubter.say("clipped", rows=rows, extreme=extreme)
    # A command may jump from row to row, and no sensor measures it: it has neither spikes nor noise.
    is_command = doubter.channel in COMMANDS
    if not is_command:
        yield from doubt_spikes(doubter, values)
    if doubter.rate is None or is_command:
        return
    level, step = measure_level(values[:MOST_ROWS], doubter.rate), _find_resolution(values[:MOST_ROWS])
    usual = float(np.median(lengths[:MOST_ROWS]))
    if usual >= 2.0 and np.mean(lengths == usual) > REGULAR:
        yield doubter.say("held", rows=usual)
    if np.isfinite(level.fourth):
        yield from _floor(doubter, level, step, 0.5 * float(np.ptp(values)))


def doubt_dropouts(
    doubter: Doubter, values: Array, lengths: NDArray[np.int_], starts: NDArray[np.int_]
) -> Iterator[Issue]:
    """Yield stretches in which a channel stands still that it came to, or left, by a jump."""
    usual = float(np.quantile(lengths[:: max(1, len(lengths) // MOST_ROWS)], 0.999))
    long = np.flatnonzero(lengths >= max(_DROPOUT, 3.0 * usual))
    if not long.size:
        return
    jumps = np.abs(np.diff(values))
    least = _JUMP * float(np.median(jumps[jumps > 0.0][:MOST_ROWS]))
    found = [k for k in long if max(_jump(jumps, starts[k] - 1), _jump(jumps, starts[k] + lengths[k] - 1)) > least]
    if found:
        first, rows = int(starts[found[0]]), int(np.sum(lengths[found]))
        places = f"{rows} rows in {len(found)} places" if len(found) > 1 else f"{rows} rows"
        yield doubter.say("dropout", value=values[first], places=places, first=doubter.at(first))


def _jump(jumps: Array, row: int) -> float:
    return float(jumps[row]) if 0 <= row < len(jumps) else 0.0


def doubt_spikes(doubter: Doubter, values: Array, least: float = NOTABLE) -> Iterator[Issue]:
    """Yield the single rows that jump away from both neighbours, by `least` standard deviations of the channel."""
    rows = find_spikes(values)
    rows = rows[np.abs(values[rows] - 0.5 * (values[rows - 1] + values[rows + 1])) > least * np.std(values)]
    if len(rows):
        size = float(np.max(np.abs(values[rows] - 0.5 * (values[rows - 1] + values[rows + 1]))))
        yield doubter.say("spikes", count=len(rows), size=size, first=doubter.at(int(rows[0])))


def find_spikes(values: Array, factor: float = _SPIKE) -> NDArray[np.int_]:
    """Return the rows that jump away from both neighbours, by far more than anything around them bends.

    `factor` is how many times as much as usual they bend.
    """
    if len(values) < _LEAST_FOR_SPIKES:
        return np.empty(0, dtype=np.int_)
    bend = np.abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    usual = 1.4826 * float(np.median(bend[:MOST_ROWS])) + 1e-9 * float(np.ptp(values))
    rows = np.flatnonzero(bend > factor * usual)
    if len(rows) > _MOST_CANDIDATES:
        return np.empty(0, dtype=np.int_)
    return np.array([row + 1 for row in rows if _stands_alone(values, bend, int(row))], dtype=np.int_)


def _stands_alone(values: Array, bend: Array, row: int) -> bool:
    """Say whether one row is a spike: its neighbours agree, and nothing near bends nearly as much."""
    before, at, after = values[row : row + 3]
    agree = abs(after - before) < 0.3 * min(abs(at - before), abs(at - after))
    near = np.concatenate([bend[max(0, row - _AROUND) : max(0, row - 1)], bend[row + 2 : row + _AROUND]])
    return bool(agree and bend[row] > _ALONE * float(np.max(near, initial=0.0)))


def _floor(doubter: Doubter, level: Level, step: float, swing: float) -> Iterator[Issue]:
    """Yield that the floor at high frequencies is none of a sensor: it falls, or is that of the resolution."""
    if level.fourth < _COARSE * step:
        yield doubter.say("resolution", step=step)
    elif level.fourth < max(_SMOOTH * level.third, SILENT * swing):
        yield doubter.say("smooth")


def _find_resolution(values: Array) -> float:
    """Return the step between the levels that values come in, 0 where they come in none."""
    gaps = np.diff(np.unique(values))
    low, usual = (float(np.quantile(gaps, share)) for share in (0.1, 0.5))
    return low if low > _LEVELLED * usual else 0.0


def noise_of(values: Array, rate: float | None) -> float | None:
    """Return the RMS of white noise that the floor at high frequencies shows, None where it is too short to tell."""
    finite = values[np.isfinite(values)]
    level: Level = measure_level(finite[:MOST_ROWS], rate or 100.0)
    return float(level.fourth) if np.isfinite(level.fourth) else None
