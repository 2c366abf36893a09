"""Whether the stated noise of a channel is the noise that its record shows.

What is seen is the white noise in the quietest fifth of half seconds, from third and from fourth differences, which
agree where it is white. More than is stated need not be noise of the sensor, which neither grows with the motion nor
comes again when an excitation is repeated: broadband motion does. Less than is stated may be noise that a filter took
the high frequencies from: what is left there says nothing of the rest, and the difference of two repeats shows all.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from seatsim.recordings.quality.damage import SILENT
from seatsim.recordings.quality.issue import Issue, issue_in_all_runs
from seatsim.recordings.quality.run_under_test import RunUnderTest
from seatsim.recordings.quality.shapes import Level, measure_level, quantum
from seatsim.schema.arrays import Array

NOISE_OFF = 3.0
"""Factor by which the noise may differ from what is stated."""
WHITE = 0.9
"""Share of the level of third differences that fourth ones have at least where both are of white noise."""
GROWS = 1.5
"""Ratio of the levels in the liveliest and the calmest fifth of windows above which it grows with the motion."""
REPEATS = 0.67
"""Share of the level seen that the difference of two repeats has at most where what is seen repeats itself."""


def check_noise(runs: Sequence[RunUnderTest]) -> Iterator[Issue]:
    """Compare the stated noise with the least white noise seen in any run."""
    for channel, entry in runs[0].recording.channels.items():
        stated = entry.noise_rms
        seen = min((measure_level(run.table[channel], run.rate) for run in runs), key=lambda level: level.fourth)
        if channel == "current_command" or stated == 0.0 or not 0.0 < seen.fourth < np.inf:
            continue
        repeated = _repeated(runs, channel)
        all_of = _all_of(repeated)
        text = f"noise_rms is stated as {stated:g}, but about {seen.fourth:.2g} is seen"
        is_too_small = seen.third > NOISE_OFF * stated and seen.fourth > WHITE * seen.third
        if is_too_small and (reason := _not_of_the_sensor(seen, repeated, runs[0].rate)):
            yield issue_in_all_runs("note", "noise", f"{text}, which {reason}: it is no noise of the sensor", channel)
        elif is_too_small:
            yield issue_in_all_runs("warning", "noise", f"{text}; correct it, all thresholds hang on it", channel)
        elif all_of < stated / NOISE_OFF:
            text = f"noise_rms is stated as {stated:g}, but repeats differ by {all_of:.2g} only"
            yield issue_in_all_runs("warning", "noise", f"{text}; correct it, all thresholds hang on it", channel)
        elif seen.fourth < stated / NOISE_OFF and not all_of >= stated / NOISE_OFF:
            yield _less_is_seen(runs, channel, seen, stated)


def _less_is_seen(runs: Sequence[RunUnderTest], channel: str, seen: Level, stated: float) -> Issue:
    """Return what less noise at high frequencies than is stated means: nothing where a filter took it."""
    values = np.concatenate([run.table[channel] for run in runs])
    least = max(SILENT * 0.5 * float(np.ptp(values)), quantum(values) / 12**0.5)
    if seen.fourth < max(least, WHITE * seen.third):
        text = f"of the stated noise_rms {stated:g} next to nothing is left at high frequencies: it was filtered"
        return issue_in_all_runs("note", "noise", f"{text}, and what is left below them cannot be seen", channel)
    text = f"noise_rms is stated as {stated:g}, but about {seen.fourth:.2g} is seen at high frequencies"
    advice = "correct it if the noise is white, keep it if a filter took the rest; a repeated run shows all of it"
    return issue_in_all_runs("warning", "noise", f"{text}; {advice}", channel)


def _repeated(runs: Sequence[RunUnderTest], channel: str) -> list[Array]:
    """Return the difference of each pair of repeats over the root of 2, shape (N,): what does not repeat itself."""
    named, found = {run.name: run for run in runs}, []
    for run in runs:
        other = named.get(run.recording.runs[run.name].repeat_of or "")
        if other is not None:
            rows = min(run.rows, other.rows)
            found.append((run.table[channel][:rows] - other.table[channel][:rows]) / np.sqrt(2.0))
    return found


def _all_of(repeated: Sequence[Array]) -> float:
    """Return the RMS of what does not repeat itself, at all frequencies, NaN without repeats."""
    return min((float(np.std(values)) for values in repeated), default=np.nan)


def _not_of_the_sensor(seen: Level, repeated: Sequence[Array], rate: float) -> str:
    """Return why what is seen is not the sensor's noise, an empty string where it may be."""
    if seen.lively > GROWS * seen.calm:
        return "grows with the motion"
    if any(measure_level(values, rate).fourth < REPEATS * seen.fourth for values in repeated):
        return "comes again when the excitation is repeated"
    return ""
