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
    """A metric before there is a run: how it is described, and the channel of which it is the RMS or the peak."""

    unit: str
    meaning: str
    short: str = ""
    rms: str = ""
    peak: str = ""


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
            metrics[name] = Metric(_compute(name, run), specification.unit, specification.meaning)
        except MissingInput:
            continue
    return metrics


def _compute(name: str, run: RunRecord) -> float:
    """Return the value of a metric, or raise `MissingInput` where it lacks an input."""
    figure = METRICS[name]
    if figure.rms:
        return motion.rms(run[figure.rms])
    return motion.peak(run[figure.peak]) if figure.peak else _COMPUTED[name](run)


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
_COMPUTED: Mapping[str, Callable[[RunRecord], float]] = {
    "driver_acceleration_weighted": _of_weighted(lambda x, _: motion.rms(x)),
    "driver_vdv": _of_weighted(vdv),
    "driver_mtvv": _of_weighted(mtvv),
    "driver_crest_factor": _of_weighted(lambda x, _: crest_factor(x)),
    "driver_jerk_rms": _jerk,
    "seat_factor": _seat_factor,
    "end_stop_hits": _end_stop_hits,
    "force_tracking_error": _tracking(share=False),
    "force_tracking_error_relative": _tracking(share=True),
    "force_served_share": _served_share,
    "electrical_energy": _electrical_energy,
    "damper_energy": lambda run: float(run["energy_damper"][-1] - run["energy_damper"][0]),
    "energy_residual": _energy_residual,
    "temperature_final": lambda run: float(run["damper_temperature"][-1]),
}
METRICS: Mapping[str, _Figure] = read_packaged(Path(__file__).with_name("metrics.yaml"), dict[str, _Figure])
"""All metrics by name, in the order of the table."""
SHORT = {name: figure.short for name, figure in METRICS.items() if figure.short}
"""What metrics are called where there is little room: in tables, pictures and sentences, on paper and on a screen."""
