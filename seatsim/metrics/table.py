"""The table of one run: every metric is declared here once, with unit, meaning and how it comes about."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seatsim.metrics.arrays import ratio
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
from seatsim.metrics.record import Absent, Record


class Metric(NamedTuple):
    """One figure of a run."""

    value: float
    unit: str
    meaning: str


class Run(NamedTuple):
    """What the metrics read: the channels, and what is known of the rig (None where it is not)."""

    record: Record
    travel: tuple[float, float] | None
    coil_resistance: float | None


class MetricSpecification(NamedTuple):
    """A metric before there is a run: `value` works it out, or raises `Absent` where an input is missing."""

    unit: str
    meaning: str
    value: Callable[[Run], float]


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
    no travel or resistance stated, or a sample rate below 200 Hz where the signal must be weighted. A ratio
    over nothing (the SEAT factor on a floor at rest) is NaN. Further channels are not used.

    Args:
        history: channels by name, SI units, shape (N,) each.
        step: time between samples in s.
        travel: (low, high) of the suspension in m, for the end-stop hits.
        coil_resistance: in ohm, for the electrical energy.
        settle: start of the record in s that RMS, peak, dose and share leave out, after the weighting went
            over it. Hits, energies and the final temperature cover the whole record.

    Raises:
        InputError: step, settle, travel or resistance out of range, channels not of one length,
            or a channel that must be weighted and is not finite.
    """
    run = Run(Record(history, step, settle), travel, coil_resistance)
    metrics = {}
    for name, specification in METRICS.items():
        try:
            metrics[name] = Metric(specification.value(run), specification.unit, specification.meaning)
        except Absent:
            continue
    return metrics


def _rms(channel: str) -> Callable[[Run], float]:
    return lambda run: rms(run.record.settled(channel))


def _peak(channel: str) -> Callable[[Run], float]:
    return lambda run: peak(run.record.settled(channel))


def _weighted_rms(run: Run) -> float:
    return rms(run.record.weighted("driver_acceleration"))


def _vdv(run: Run) -> float:
    return vdv(run.record.weighted("driver_acceleration"), run.record.sample_rate)


def _mtvv(run: Run) -> float:
    return mtvv(run.record.weighted("driver_acceleration"), run.record.sample_rate)


def _crest_factor(run: Run) -> float:
    return crest_factor(run.record.weighted("driver_acceleration"))


def _seat_factor(run: Run) -> float:
    return ratio(_weighted_rms(run), rms(run.record.weighted("floor_acceleration")))


def _end_stop_hits(run: Run) -> float:
    if run.travel is None:
        raise Absent("travel")
    return float(end_stop_hits(run.record.whole("suspension_displacement"), run.travel))


def _tracking(run: Run) -> TrackingError:
    return force_tracking_error(run.record.settled("wanted_force"), run.record.settled("damper_force"))


def _tracking_error(run: Run) -> float:
    return _tracking(run).rms


def _tracking_relative(run: Run) -> float:
    return _tracking(run).relative


def _served_share(run: Run) -> float:
    served = run.record.settled("force_served")
    asked = served[~np.isnan(served)]
    return ratio(float(asked.sum()), asked.size)


def _electrical_energy(run: Run) -> float:
    if run.coil_resistance is None:
        raise Absent("coil_resistance")
    return electrical_energy(run.record.whole("coil_current"), run.coil_resistance, run.record.sample_rate)


def _damper_energy(run: Run) -> float:
    energy = run.record.whole("energy_damper")
    return float(energy[-1] - energy[0])


def _energy_residual(run: Run) -> float:
    sinks = ("energy_damper", "energy_suspension", "energy_cushion", "energy_stored")
    return energy_residual(run.record.whole("energy_floor"), [run.record.whole(name) for name in sinks])


def _temperature_final(run: Run) -> float:
    return float(run.record.whole("damper_temperature")[-1])


METRICS: Mapping[str, MetricSpecification] = {
    "driver_acceleration_rms": MetricSpecification(
        "m/s^2", "RMS acceleration of the driver", _rms("driver_acceleration")
    ),
    "driver_acceleration_peak": MetricSpecification(
        "m/s^2", "largest driver acceleration", _peak("driver_acceleration")
    ),
    "driver_acceleration_weighted": MetricSpecification("m/s^2", "RMS driver acceleration, Wk-weighted", _weighted_rms),
    "driver_vdv": MetricSpecification("m/s^1.75", "vibration dose value of the driver, Wk-weighted", _vdv),
    "driver_mtvv": MetricSpecification("m/s^2", "largest Wk-weighted RMS of the driver in any second", _mtvv),
    "driver_crest_factor": MetricSpecification(
        "-", "peak over RMS of the driver's Wk-weighted acceleration", _crest_factor
    ),
    "seat_factor": MetricSpecification(
        "-", "Wk-weighted RMS of the driver over that of the floor (SEAT)", _seat_factor
    ),
    "frame_acceleration_rms": MetricSpecification("m/s^2", "RMS acceleration of the frame", _rms("frame_acceleration")),
    "frame_acceleration_peak": MetricSpecification("m/s^2", "largest frame acceleration", _peak("frame_acceleration")),
    "suspension_displacement_rms": MetricSpecification("m", "RMS suspension travel", _rms("suspension_displacement")),
    "suspension_displacement_peak": MetricSpecification(
        "m", "largest suspension travel", _peak("suspension_displacement")
    ),
    "end_stop_hits": MetricSpecification("-", "separate excursions beyond the travel", _end_stop_hits),
    "force_tracking_error": MetricSpecification("N", "RMS of wanted less delivered force", _tracking_error),
    "force_tracking_error_relative": MetricSpecification(
        "-", "the same over the RMS of the wanted force", _tracking_relative
    ),
    "force_served_share": MetricSpecification("-", "share of time the wanted force could be delivered", _served_share),
    "current_rms": MetricSpecification("A", "RMS coil current", _rms("coil_current")),
    "electrical_energy": MetricSpecification("J", "heat of the coil", _electrical_energy),
    "damper_energy": MetricSpecification("J", "energy dissipated by the damper", _damper_energy),
    "energy_residual": MetricSpecification("-", "energy unaccounted for over the largest energy", _energy_residual),
    "temperature_final": MetricSpecification("degC", "temperature of the damper at the end", _temperature_final),
}
"""All metrics by name, in the order of the table."""
