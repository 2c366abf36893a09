"""The table of one run: every metric is declared here once, with unit, meaning and the function that computes it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics.arrays import as_signal, ratio, require_finite, require_positive
from seatsim.metrics.comfort import crest_factor, mtvv, vdv
from seatsim.metrics.motion import (
    TrackingError,
    electrical_energy,
    end_stop_hits,
    energy_residual,
    force_tracking_error,
    peak,
    rms,
)
from seatsim.metrics.weighting import can_weight, weight
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError


class Metric(NamedTuple):
    """One figure of a run."""

    value: float
    unit: str
    meaning: str


class MetricInputs(NamedTuple):
    """What the metrics read: the channels, and what is known of the rig (None where it is not).

    `travel` is (low, high) of the suspension in m, `coil_resistance` is in ohm.
    """

    channels: RunChannels
    travel: tuple[float, float] | None
    coil_resistance: float | None


class MetricSpecification(NamedTuple):
    """A metric before there is a run: `compute` returns its value, or raises `MissingInput` where it lacks an input."""

    unit: str
    meaning: str
    compute: Callable[[MetricInputs], float]


def summarise(
    history: Mapping[str, ArrayLike],
    step: float,
    *,
    travel: tuple[float, float] | None = None,
    coil_resistance: float | None = None,
    settle: float = 0.0,
) -> dict[str, Metric]:
    """Return the metrics of one run by name, in the order of `METRICS`.

    A metric whose input is absent is left out: no such channel, a channel of NaN only (no force was wanted),
    no end stops or resistance stated, or a sample rate below 200 Hz where the signal must be weighted. A ratio
    over nothing (the SEAT factor on a floor at rest) is NaN. Further channels are not used.

    Args:
        history: channels by name, SI units, shape (N,) each.
        step: time between samples in s.
        travel: (low, high) of the suspension in m, where it meets its end stops, for the hits.
        coil_resistance: in ohm, for the electrical energy.
        settle: start of the record in s that RMS, peak, dose and share leave out, after the weighting went
            over it. Hits, energies and the final temperature cover the whole record.

    Raises:
        InputError: step, settle, travel or resistance out of range, channels not of one length,
            or a channel that must be weighted and is not finite.
    """
    inputs = MetricInputs(RunChannels(history, step, settle), travel, coil_resistance)
    metrics = {}
    for name, specification in METRICS.items():
        try:
            metrics[name] = Metric(specification.compute(inputs), specification.unit, specification.meaning)
        except MissingInput:
            continue
    return metrics


def _rms_of(channel: str) -> Callable[[MetricInputs], float]:
    return lambda inputs: rms(inputs.channels.settled(channel))


def _peak_of(channel: str) -> Callable[[MetricInputs], float]:
    return lambda inputs: peak(inputs.channels.settled(channel))


def _jerk(inputs: MetricInputs) -> float:
    acceleration = inputs.channels.settled("driver_acceleration")
    if acceleration.size < 2:
        raise MissingInput("driver_acceleration")
    return rms(np.diff(acceleration) * inputs.channels.sample_rate)


def _weighted_rms(inputs: MetricInputs) -> float:
    return rms(inputs.channels.weighted("driver_acceleration"))


def _vdv(inputs: MetricInputs) -> float:
    return vdv(inputs.channels.weighted("driver_acceleration"), inputs.channels.sample_rate)


def _mtvv(inputs: MetricInputs) -> float:
    return mtvv(inputs.channels.weighted("driver_acceleration"), inputs.channels.sample_rate)


def _crest_factor(inputs: MetricInputs) -> float:
    return crest_factor(inputs.channels.weighted("driver_acceleration"))


def _seat_factor(inputs: MetricInputs) -> float:
    return ratio(_weighted_rms(inputs), rms(inputs.channels.weighted("floor_acceleration")))


def _end_stop_hits(inputs: MetricInputs) -> float:
    if inputs.travel is None:
        raise MissingInput("travel")
    return float(end_stop_hits(inputs.channels.whole("suspension_displacement"), inputs.travel))


def _tracking(inputs: MetricInputs) -> TrackingError:
    return force_tracking_error(inputs.channels.settled("wanted_force"), inputs.channels.settled("damper_force"))


def _tracking_error(inputs: MetricInputs) -> float:
    return _tracking(inputs).rms


def _tracking_relative(inputs: MetricInputs) -> float:
    return _tracking(inputs).relative


def _served_share(inputs: MetricInputs) -> float:
    served = inputs.channels.settled("force_served")
    # NaN where the law wants no force: such samples are neither served nor missed.
    asked = served[~np.isnan(served)]
    return ratio(float(asked.sum()), asked.size)


def _electrical_energy(inputs: MetricInputs) -> float:
    if inputs.coil_resistance is None:
        raise MissingInput("coil_resistance")
    return electrical_energy(inputs.channels.whole("coil_current"), inputs.coil_resistance, inputs.channels.sample_rate)


def _damper_energy(inputs: MetricInputs) -> float:
    energy = inputs.channels.whole("energy_damper")
    return float(energy[-1] - energy[0])


def _energy_residual(inputs: MetricInputs) -> float:
    sinks = ("energy_damper", "energy_suspension", "energy_cushion", "energy_stored")
    return energy_residual(inputs.channels.whole("energy_floor"), [inputs.channels.whole(name) for name in sinks])


def _temperature_final(inputs: MetricInputs) -> float:
    return float(inputs.channels.whole("damper_temperature")[-1])


METRICS: Mapping[str, MetricSpecification] = {
    "driver_acceleration_rms": MetricSpecification(
        "m/s^2", "RMS acceleration of the driver", _rms_of("driver_acceleration")
    ),
    "driver_acceleration_peak": MetricSpecification(
        "m/s^2", "largest driver acceleration", _peak_of("driver_acceleration")
    ),
    "driver_acceleration_weighted": MetricSpecification("m/s^2", "RMS driver acceleration, Wk-weighted", _weighted_rms),
    "driver_vdv": MetricSpecification("m/s^1.75", "vibration dose value of the driver, Wk-weighted", _vdv),
    "driver_mtvv": MetricSpecification("m/s^2", "largest Wk-weighted RMS of the driver in any second", _mtvv),
    "driver_crest_factor": MetricSpecification(
        "-", "peak over RMS of the driver's Wk-weighted acceleration", _crest_factor
    ),
    "driver_jerk_rms": MetricSpecification(
        "m/s^3", "RMS jerk of the driver: differences of successive samples over the step", _jerk
    ),
    "seat_factor": MetricSpecification(
        "-", "Wk-weighted RMS of the driver over that of the floor (SEAT)", _seat_factor
    ),
    "frame_acceleration_rms": MetricSpecification(
        "m/s^2", "RMS acceleration of the frame", _rms_of("frame_acceleration")
    ),
    "frame_acceleration_peak": MetricSpecification(
        "m/s^2", "largest frame acceleration", _peak_of("frame_acceleration")
    ),
    "suspension_displacement_rms": MetricSpecification(
        "m", "RMS suspension travel", _rms_of("suspension_displacement")
    ),
    "suspension_displacement_peak": MetricSpecification(
        "m", "largest suspension travel", _peak_of("suspension_displacement")
    ),
    "end_stop_hits": MetricSpecification("-", "separate excursions beyond the end stops", _end_stop_hits),
    "force_tracking_error": MetricSpecification("N", "RMS of wanted less delivered force", _tracking_error),
    "force_tracking_error_relative": MetricSpecification(
        "-", "the same over the RMS of the wanted force", _tracking_relative
    ),
    "force_served_share": MetricSpecification("-", "share of time the wanted force could be delivered", _served_share),
    "current_rms": MetricSpecification("A", "RMS coil current", _rms_of("coil_current")),
    "electrical_energy": MetricSpecification("J", "heat of the coil", _electrical_energy),
    "damper_energy": MetricSpecification("J", "energy dissipated by the damper", _damper_energy),
    "energy_residual": MetricSpecification("-", "energy unaccounted for over the largest energy", _energy_residual),
    "temperature_final": MetricSpecification("degC", "temperature of the damper at the end", _temperature_final),
}
"""All metrics by name, in the order of the table."""
SHORT: Mapping[str, str] = {
    "driver_acceleration_rms": "driver RMS", "driver_acceleration_weighted": "driver Wk RMS",
    "driver_vdv": "driver VDV", "seat_factor": "SEAT factor", "suspension_displacement_rms": "travel RMS",
    "suspension_displacement_peak": "travel peak", "end_stop_hits": "end-stop hits", "driver_jerk_rms": "driver jerk",
    "current_rms": "current RMS",
}  # fmt: skip
"""What metrics are called where there is little room: in tables, pictures and sentences, on paper and on a screen."""


class MissingInput(Exception):  # noqa: N818 - not an error: the metric that asked is left out
    """What a metric asked for is not in the record."""


class RunChannels:
    """Channels of one run, all of one length, sampled every `step` s; the first `settle` seconds are its start-up.

    Raises:
        InputError: step or settle is out of range, or the channels differ in length.
    """

    def __init__(self, channels: Mapping[str, ArrayLike], step: float, settle: float) -> None:
        self.sample_rate = 1 / require_positive(step, "step")
        self._channels = {name: as_signal(values, name) for name, values in channels.items()}
        self._weighted: dict[str, Array] = {}
        self._check(settle)
        self._start = round(settle * self.sample_rate)

    def whole(self, name: str) -> Array:
        """Return a channel over the whole record; one that holds nothing but NaN counts as absent.

        Raises:
            MissingInput: the channel is not there.
        """
        # A channel of NaN is how a history says that a law wants no force: there is nothing to average.
        values = self._channels.get(name)
        if values is None or (math.isnan(values[0]) and np.isnan(values).all()):
            raise MissingInput(name)
        return values

    def settled(self, name: str) -> Array:
        """Return a channel without the start of the record.

        Raises:
            MissingInput: the channel is not there.
        """
        return self.whole(name)[self._start :]

    def weighted(self, name: str) -> Array:
        """Return a channel weighted with Wk over the whole record, then without the start-up; worked out once.

        The weighting comes first: its high-pass takes 2 s to forget where the record begins, so that cutting
        before it would add a transient to what is kept.

        Raises:
            MissingInput: the channel is not there, or its sample rate is too low for the weighting.
            InputError: a sample is not finite.
        """
        if name not in self._weighted:
            if not can_weight(self.sample_rate):
                raise MissingInput(name)
            self._weighted[name] = weight(require_finite(self.whole(name), name), self.sample_rate)
        return self._weighted[name][self._start :]

    def _check(self, settle: float) -> None:
        lengths = {name: values.size for name, values in self._channels.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"channels: have different numbers of samples, {lengths}; must all be the same")
        samples = min(lengths.values(), default=math.inf)
        # Half a sample short of the record, so that rounding leaves at least one sample to average.
        if not 0 <= settle * self.sample_rate < samples - 0.5:
            lasts = samples / self.sample_rate
            raise InputError(f"settle: is {settle} s; must be 0 or more and less than the record's {lasts:g} s")
