"""The table of one run: every metric is declared here once, with unit, meaning and the function that computes it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics import motion
from seatsim.metrics.comfort import crest_factor, mtvv, vdv
from seatsim.metrics.weighting import can_weight, weight
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import read_packaged


class Metric(NamedTuple):
    """One figure of a run."""

    value: float
    unit: str
    meaning: str


class MissingInput(Exception):  # noqa: N818 - not an error: the metric that asked is left out
    """What a metric asked for is not in the record."""


class RunRecord:
    """What the metrics read of a run: its channels, all of one length, every `step` s, and what is known of the rig.

    `travel` is (low, high) of the suspension in m, `coil_resistance` is in ohm; None where it is not known.

    Raises:
        InputError: the step is out of range, or the channels differ in length.
    """

    def __init__(
        self,
        channels: Mapping[str, ArrayLike],
        step: float,
        travel: tuple[float, float] | None = None,
        coil_resistance: float | None = None,
    ) -> None:
        self.rate = 1 / motion.require_positive(step, "step")
        self.channels = {name: motion.as_signal(values, name) for name, values in channels.items()}
        self.weighted_channels: dict[str, Array] = {}
        self.travel, self.coil_resistance = travel, coil_resistance
        lengths = {name: values.size for name, values in self.channels.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"channels: have different numbers of samples, {lengths}; must all be the same")

    def __getitem__(self, name: str) -> Array:
        """Return a channel; one that holds nothing but NaN counts as absent.

        Raises:
            MissingInput: the channel is not there.
        """
        # A channel of NaN is how a history says that a law wants no force: there is nothing to average.
        values = self.channels.get(name)
        if values is None or (math.isnan(values[0]) and np.isnan(values).all()):
            raise MissingInput(name)
        return values

    def weighted(self, name: str) -> Array:
        """Return a channel weighted with Wk; worked out once.

        Raises:
            MissingInput: the channel is not there, or its sample rate is too low for the weighting.
            InputError: a sample is not finite.
        """
        if name not in self.weighted_channels:
            if not can_weight(self.rate):
                raise MissingInput(name)
            self.weighted_channels[name] = weight(motion.require_finite(self[name], name), self.rate)
        return self.weighted_channels[name]


class _Figure(NamedTuple):
    """A metric before there is a run: `compute` returns its value, or raises `MissingInput` where it lacks an input."""

    unit: str
    meaning: str
    compute: Callable[[RunRecord], float]


def summarise(
    history: Mapping[str, ArrayLike],
    step: float,
    *,
    travel: tuple[float, float] | None = None,
    coil_resistance: float | None = None,
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

    Raises:
        InputError: step, travel or resistance out of range, channels not of one length, or a channel that must be
            weighted and is not finite.
    """
    run = RunRecord(history, step, travel, coil_resistance)
    metrics = {}
    for name, specification in METRICS.items():
        try:
            metrics[name] = Metric(specification.compute(run), specification.unit, specification.meaning)
        except MissingInput:
            continue
    return metrics


def _rms_of(channel: str) -> Callable[[RunRecord], float]:
    return lambda run: motion.rms(run[channel])


def _peak_of(channel: str) -> Callable[[RunRecord], float]:
    return lambda run: motion.peak(run[channel])


def _of_weighted(compute: Callable[[Array, float], float]) -> Callable[[RunRecord], float]:
    """Return what computes a figure of the driver's Wk-weighted acceleration and its sample rate."""
    return lambda run: compute(run.weighted(_DRIVER), run.rate)


def _tracking(share: bool) -> Callable[[RunRecord], float]:
    return lambda run: motion.force_tracking_error(run["wanted_force"], run["damper_force"])[int(share)]


def _seat_factor(run: RunRecord) -> float:
    return motion.ratio(motion.rms(run.weighted(_DRIVER)), motion.rms(run.weighted("floor_acceleration")))


def _jerk(run: RunRecord) -> float:
    acceleration = run["driver_acceleration"]
    if acceleration.size < 2:
        raise MissingInput("driver_acceleration")
    return motion.rms(np.diff(acceleration) * run.rate)


def _end_stop_hits(run: RunRecord) -> float:
    if run.travel is None:
        raise MissingInput("travel")
    return float(motion.end_stop_hits(run["suspension_displacement"], run.travel))


def _served_share(run: RunRecord) -> float:
    served = run["force_served"]
    # NaN where the law wants no force: such samples are neither served nor missed.
    asked = served[~np.isnan(served)]
    return motion.ratio(float(asked.sum()), asked.size)


def _electrical_energy(run: RunRecord) -> float:
    if run.coil_resistance is None:
        raise MissingInput("coil_resistance")
    return motion.electrical_energy(run["coil_current"], run.coil_resistance, run.rate)


def _energy_residual(run: RunRecord) -> float:
    sinks = ("energy_damper", "energy_suspension", "energy_cushion", "energy_stored")
    return motion.energy_residual(run["energy_floor"], [run[name] for name in sinks])


COMFORT, UNWEIGHTED = "driver_acceleration_weighted", "driver_acceleration_rms"
TRAVEL, SEAT = "suspension_displacement_rms", "seat_factor"
"""Metrics by which seats are compared."""
_DRIVER = "driver_acceleration"
METRICS: Mapping[str, _Figure] = {
    "driver_acceleration_rms": _Figure("m/s^2", "RMS acceleration of the driver", _rms_of(_DRIVER)),
    "driver_acceleration_peak": _Figure("m/s^2", "largest driver acceleration", _peak_of(_DRIVER)),
    "driver_acceleration_weighted": _Figure(
        "m/s^2", "RMS driver acceleration, Wk-weighted", _of_weighted(lambda x, _: motion.rms(x))
    ),
    "driver_vdv": _Figure("m/s^1.75", "vibration dose value of the driver, Wk-weighted", _of_weighted(vdv)),
    "driver_mtvv": _Figure("m/s^2", "largest Wk-weighted RMS of the driver in any second", _of_weighted(mtvv)),
    "driver_crest_factor": _Figure(
        "-", "peak over RMS of the driver's Wk-weighted acceleration", _of_weighted(lambda x, _: crest_factor(x))
    ),
    "driver_jerk_rms": _Figure(
        "m/s^3", "RMS jerk of the driver: differences of successive samples over the step", _jerk
    ),
    "seat_factor": _Figure("-", "Wk-weighted RMS of the driver over that of the floor (SEAT)", _seat_factor),
    "frame_acceleration_rms": _Figure("m/s^2", "RMS acceleration of the frame", _rms_of("frame_acceleration")),
    "frame_acceleration_peak": _Figure("m/s^2", "largest frame acceleration", _peak_of("frame_acceleration")),
    "suspension_displacement_rms": _Figure("m", "RMS suspension travel", _rms_of("suspension_displacement")),
    "suspension_displacement_peak": _Figure("m", "largest suspension travel", _peak_of("suspension_displacement")),
    "end_stop_hits": _Figure("-", "separate excursions beyond the end stops", _end_stop_hits),
    "force_tracking_error": _Figure("N", "RMS of wanted less delivered force", _tracking(share=False)),
    "force_tracking_error_relative": _Figure("-", "the same over the RMS of the wanted force", _tracking(share=True)),
    "force_served_share": _Figure("-", "share of time the wanted force could be delivered", _served_share),
    "current_rms": _Figure("A", "RMS coil current", _rms_of("coil_current")),
    "electrical_energy": _Figure("J", "heat of the coil", _electrical_energy),
    "damper_energy": _Figure(
        "J", "energy dissipated by the damper", lambda run: float(run["energy_damper"][-1] - run["energy_damper"][0])
    ),
    "energy_residual": _Figure("-", "energy unaccounted for over the largest energy", _energy_residual),
    "temperature_final": _Figure(
        "degC", "temperature of the damper at the end", lambda run: float(run["damper_temperature"][-1])
    ),
}
"""All metrics by name, in the order of the table."""
SHORT = read_packaged(Path(__file__).with_name("short_names.yaml"), dict[str, str])
"""What metrics are called where there is little room: in tables, pictures and sentences, on paper and on a screen."""
