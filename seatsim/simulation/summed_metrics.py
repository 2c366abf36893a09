"""The metrics that the sums of a run give, as `seatsim.metrics` defines them."""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.kernel.sums import Sums
from seatsim.metrics.arrays import ratio


class RigOfSums(NamedTuple):
    """What the metrics need beside the sums: step in s, resistance of the coil in ohm, final temperature in degC."""

    step: float
    resistance: float
    temperature: float


def metrics_of_sums(sums: Sums, samples: int, rig: RigOfSums) -> dict[str, float]:
    """Return the metrics that the sums give; those of the wanted force only where there was one."""
    # Sum of squares less half of the first and the last one: the trapezoidal rule.
    heat = sums.current - 0.5 * (sums.first_current**2 + sums.last_current**2)
    found = {
        "frame_acceleration_rms": math.sqrt(sums.frame / samples),
        "frame_acceleration_peak": sums.frame_peak,
        "suspension_displacement_rms": math.sqrt(sums.displacement / samples),
        "suspension_displacement_peak": sums.displacement_peak,
        "end_stop_hits": sums.hits,
        "current_rms": math.sqrt(sums.current / samples),
        "electrical_energy": rig.resistance * heat * rig.step,
        "damper_energy": sums.damper_energy,
        "energy_residual": sums.imbalance / sums.energy if sums.energy else 0.0,
        "temperature_final": rig.temperature,
    }
    if sums.asked:
        error = math.sqrt(sums.missed / sums.asked)
        found["force_tracking_error"] = error
        found["force_tracking_error_relative"] = ratio(error, math.sqrt(sums.wanted / sums.asked))
        found["force_served_share"] = ratio(sums.served, sums.asked)
    return found
