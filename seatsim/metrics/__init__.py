"""What comes out of a run: comfort, motion, force and energy as single figures, and the spectra behind them.

Everything here is a function of sampled signals in SI units: no scenario, no simulation, no file is known.
"""

from seatsim.metrics.comfort import (
    Dose,
    SeatTransmission,
    crest_factor,
    daily_exposure,
    daily_vdv,
    dose,
    estimated_vdv,
    find_shocks,
    join_doses,
    motion_sickness_dose,
    mtvv,
    running_rms,
    seat_factor,
    seat_transmission,
    vdv,
    weighted_rms,
)
from seatsim.metrics.exposure import DIRECTIONS, Direction, Exposure, assess_exposure, direction
from seatsim.metrics.motion import (
    TrackingError,
    electrical_energy,
    end_stop_hits,
    energy_residual,
    force_tracking_error,
    peak,
    rms,
)
from seatsim.metrics.spectra import Transmissibility, cross_spectral_density, power_spectral_density, transmissibility
from seatsim.metrics.table import METRICS, Metric, MetricSpecification, summarise
from seatsim.metrics.weighting import WEIGHTINGS, Weighting, frequency_response, weight

__all__ = [
    "DIRECTIONS",
    "METRICS",
    "WEIGHTINGS",
    "Direction",
    "Dose",
    "Exposure",
    "Metric",
    "MetricSpecification",
    "SeatTransmission",
    "TrackingError",
    "Transmissibility",
    "Weighting",
    "assess_exposure",
    "crest_factor",
    "cross_spectral_density",
    "daily_exposure",
    "daily_vdv",
    "direction",
    "dose",
    "electrical_energy",
    "end_stop_hits",
    "energy_residual",
    "estimated_vdv",
    "find_shocks",
    "force_tracking_error",
    "frequency_response",
    "join_doses",
    "motion_sickness_dose",
    "mtvv",
    "peak",
    "power_spectral_density",
    "rms",
    "running_rms",
    "seat_factor",
    "seat_transmission",
    "summarise",
    "transmissibility",
    "vdv",
    "weight",
    "weighted_rms",
]
