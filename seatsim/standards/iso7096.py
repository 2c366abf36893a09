"""What ISO 7096 asks of a seat: acceptance values by spectral class, test persons, damping test.

Everything here is *recalled*: the standard's own text was not read. The clause that each value belongs to is that of
the 2000 edition; the 2020 edition adds a damping test for active and semi-active suspensions (5.5.3), not known here.
"""

from __future__ import annotations

from typing import NamedTuple

from seatsim.excitations.iso7096 import SpectralClass

ACCEPTANCE, DAMPING = "ISO 7096:2000, 5.5.1 and 6 (recalled)", "ISO 7096:2000, 5.5.2 and 6 (recalled)"
"""Clauses of the simulated input vibration test and of the damping test with their acceptance values."""

RECALLED = (
    "limits, test persons and details of ISO 7096 are recalled, not read in the standard: no certificate rests on them"
)


class ClassLimits(NamedTuple):
    """Acceptance values of one spectral class, and the machines that it stands for."""

    seat: float
    """Greatest SEAT factor."""
    transmissibility: float
    """Greatest transmissibility at resonance in the damping test."""
    machines: str


LIMITS: dict[SpectralClass, ClassLimits] = {
    "EM1": ClassLimits(1.1, 1.5, "articulated or rigid frame dumper"),
    "EM2": ClassLimits(0.9, 1.5, "scraper without axle or frame suspension"),
    "EM3": ClassLimits(1.0, 1.5, "wheel loader"),
    "EM4": ClassLimits(1.1, 1.5, "grader"),
    "EM5": ClassLimits(0.7, 2.0, "wheel dozer, soil compactor, backhoe loader"),
    "EM6": ClassLimits(0.7, 1.5, "crawler loader, crawler dozer"),
    "EM7": ClassLimits(0.6, 2.0, "compact dumper"),
    "EM8": ClassLimits(0.8, 2.0, "compact loader"),
    "EM9": ClassLimits(0.9, 2.0, "skid-steer loader"),
}

PERSONS = {"light": 55.0, "heavy": 98.0}
"""Mass of the two test persons in kg: 52 to 55 and 98 to 103 are permitted."""

SEATED_SHARE = 0.736
"""Share of a person's mass that rests on the seat, the feet on the floor (Boileau and Rakheja 1998; recalled)."""

INERT_MASS = 75.0
"""Mass on the seat in the damping test in kg (ISO 10326-1:2016, 10.3)."""

STROKE_SHARE, LARGEST_STROKE = 0.4, 0.05
"""Peak-to-peak motion of the floor in the damping test: this share of the travel, but no more than 50 mm (recalled)."""

FREQUENCY_STEP = 0.05
"""Hz between two tones of the damping test (recalled); they reach from half to twice the resonance expected."""
