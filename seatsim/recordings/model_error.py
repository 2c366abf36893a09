"""What a scenario leaves beyond stated noise, by channel and frequency band, and what that predicts elsewhere."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.schema.arrays import Array
from seatsim.schema.content import Form, Unwritten, written
from seatsim.schema.errors import InputError

_Signals = Mapping[str, Array]

BANDS = 7
"""Octaves down from the highest compared frequency; the lowest band begins above 0, the highest one has no end."""
_QUIET = 0.01
"""Share of a channel's power below which a band shows nothing of its own; it is taken to be as all bands are."""
LARGEST_RATIO = 10.0
"""Most by which the measured amplitude of a band may differ from the simulated one and still be followed."""

_LARGEST_ERROR = 3.0
"""Most that counts of an error in a band where a run had next to no signal."""


def band_edges(highest: float) -> Array:
    """Return the lower edges in Hz of the mean, which is a band of its own, and of octaves below `highest`."""
    return np.concatenate([[0.0, np.finfo(float).tiny], highest / 2.0 ** np.arange(BANDS - 1, 0, -1)])


def band_powers(values: Array, rate: float, edges: Array) -> Array:
    """Return the mean square of a signal, shape (N,), by frequency band, shape (bands,); Parseval: they add up."""
    power = np.abs(np.fft.rfft(values)) ** 2 / len(values) ** 2
    power[1 : (len(values) + 1) // 2] *= 2.0
    band = np.searchsorted(edges, np.fft.rfftfreq(len(values), 1.0 / rate), side="right") - 1
    return np.asarray(np.bincount(band, power, minlength=len(edges)), dtype=np.float64)


def band_widths(rate: float, edges: Array) -> Array:
    """Return the share of white noise that lies in each band, shape (bands,)."""
    limits = np.minimum(np.append(edges, np.inf), 0.5 * rate)
    return np.asarray(np.diff(limits) / (0.5 * rate))


class RunError(NamedTuple):
    """What is left of the channels of a run: the error by band, and the RMS of all bands together in the unit."""

    run: str
    channels: dict[str, Array]
    missed_rms: dict[str, float]


class ModelError(NamedTuple):
    """What a scenario leaves of each measured channel beyond stated noise, by frequency band.

    With the mean squares E of `measured - simulated`, M of measured and S of simulated in a band, and N of the noise,

        error = sqrt(max(E - N, 0) / M),    ratio = sqrt(M / S)  (within `LARGEST_RATIO`).

    The first band is the mean, whose error counts relative to the standard deviation of the channel.

    Attributes:
        edges: lower edge of each band in Hz, shape (bands,).
        noise: stated noise of each channel, in its unit.
        error: by channel, shape (runs, bands); of all runs together in `pooled`.
        ratio: by channel, of all runs together, shape (bands,).
        pooled: by channel, shape (bands,).
        missed: mean square `max(E - N, 0)` of all bands together by channel, in its unit squared, shape (runs,).
        runs: names, in the order of the rows of `error`.
    """

    edges: Unwritten[Array]
    noise: Annotated[dict[str, float], Form(key="noise_rms")]
    error: Unwritten[dict[str, Array]]
    ratio: Annotated[dict[str, Array], Form(key="measured_over_simulated")]
    pooled: Annotated[dict[str, Array], Form(key="channels")]
    missed: Unwritten[dict[str, Array]]
    runs: Unwritten[tuple[str, ...]]

    @property
    @written()
    def bands(self) -> list[tuple[float, float]]:
        """Lower and upper edge of each band in Hz; the last one has no upper edge."""
        return list(pairwise([*map(float, self.edges), np.inf]))

    @property
    @written()
    def by_run(self) -> list[RunError]:
        """What was left of each run."""
        missed = [{name: float(np.sqrt(v[k])) for name, v in self.missed.items()} for k in range(len(self.runs))]
        errors = [{name: values[k] for name, values in self.error.items()} for k in range(len(self.runs))]
        return list(map(RunError, self.runs, errors, missed))

    def predict_amplitude(self, channel: str, simulated: Array, rate: float) -> Array:
        """Return the mean square to be expected of a measured channel by band, in the first place that of all bands."""
        powers = band_powers(simulated - np.mean(simulated), rate, self.edges) * self.ratio[channel] ** 2
        return _with_whole(powers)

    def predict_remainder(self, channel: str, simulated: Array, rate: float) -> Array:
        """Return the mean square that is to stay of a channel beside noise, by each diagnosed run, shape (2, runs).

        A form that is wrong misses the same share of any amplitude; a disturbance is the same at any amplitude. Few
        runs do not tell one from the other: the first row has the shares of the runs, the second what they missed.
        """
        limited = np.minimum(self.error[channel], _LARGEST_ERROR)
        return np.array([limited**2 @ self.predict_amplitude(channel, simulated, rate), self.missed[channel]])


def measure_model_error(
    runs: Iterable[tuple[str, _Signals, _Signals]], noise: Mapping[str, float], rate: float, highest: float
) -> ModelError:
    """Return what a scenario leaves.

    Args:
        runs: name, measured and simulated channels of each run, shape (N,) each; all runs have the same channels.
        noise: stated noise of the channels.
        rate: rows per second.
        highest: highest compared frequency in Hz.
    """
    edges, pairs = band_edges(min(highest, 0.5 * rate)), list(runs)
    widths = band_widths(rate, edges)
    powers = {
        name: np.array([_powers(measured[name], simulated[name], rate, edges) for _, measured, simulated in pairs])
        for name in noise
    }
    left = {name: np.maximum(value[:, 0] - noise[name] ** 2 * widths, 0.0) for name, value in powers.items()}
    sums = {name: np.sum(value, axis=0) for name, value in powers.items()}
    return ModelError(
        edges,
        dict(noise),
        {name: np.array(list(map(_root_ratio, left[name], value[:, 1]))) for name, value in powers.items()},
        {name: np.clip(_root_ratio(s[1], s[2]), 1.0 / LARGEST_RATIO, LARGEST_RATIO) for name, s in sums.items()},
        {name: _root_ratio(np.sum(left[name], axis=0), s[1]) for name, s in sums.items()},
        {name: np.sum(value, axis=1) for name, value in left.items()},
        tuple(name for name, _, _ in pairs),
    )


def _powers(measured: Array, simulated: Array, rate: float, edges: Array) -> Array:
    """Return the band powers of residual, measured and simulated channel, shape (3, bands); the first has its mean."""
    residual = band_powers(measured - simulated, rate, edges)
    signals = [band_powers(values - np.mean(values), rate, edges) for values in (measured, simulated)]
    return np.array([residual, *map(_with_whole, signals)])


def _with_whole(powers: Array) -> Array:
    """Return band powers with that of all bands in the place of the mean's."""
    return np.concatenate([[np.sum(powers[1:])], powers[1:]])


def _root_ratio(above: Array, below: Array) -> Array:
    """Return the root of a ratio of powers, shape (bands,); of all bands where one is quiet, 0 where all are silent."""
    quiet = below <= _QUIET * below[0]
    whole = np.sum(above[1:]) / below[0] if below[0] > 0.0 else 0.0
    return np.asarray(np.sqrt(np.where(quiet, whole, above / np.where(quiet, 1.0, below))))


def read_model_error(content: Mapping[str, object], place: str) -> ModelError:
    """Return the model error that stands in a `diagnosis.json`.

    Raises:
        InputError: it is not there or not of this form.
    """
    stated = content.get("model_error")
    try:
        assert isinstance(stated, Mapping)
        by_run: Sequence[Mapping[str, object]] = stated["by_run"]
        pooled = _arrays(stated["channels"])
        return ModelError(
            np.array([low for low, _ in stated["bands"]], dtype=np.float64),
            {str(name): float(value) for name, value in stated["noise_rms"].items()},
            {name: np.array([_arrays(run["channels"])[name] for run in by_run]) for name in pooled},
            _arrays(stated["measured_over_simulated"]),
            pooled,
            {name: np.array([_arrays(run["missed_rms"])[name] for run in by_run]) ** 2 for name in pooled},
            tuple(str(run["run"]) for run in by_run),
        )
    except (AssertionError, KeyError, TypeError, ValueError, AttributeError) as error:
        problem = f"{place}: states no model_error by channel and band; diagnose the recording again"
        raise InputError(problem) from error


def _arrays(values: object) -> dict[str, Array]:
    """Return lists of numbers by name as arrays."""
    assert isinstance(values, Mapping)
    return {str(name): np.asarray(row, dtype=np.float64) for name, row in values.items()}
