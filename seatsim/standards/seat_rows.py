"""What ISO 7096 asks of a seat, and the lines of its test: what was found, and whether it is within the limits.

Values, persons and the damping test are *recalled*: the standard's own text was not read. The clause that each value
belongs to is that of the 2000 edition.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.excitations.iso7096 import SpectralClass
from seatsim.schema.content import Form, show_record

ACCEPTANCE, DAMPING = "ISO 7096:2000, 5.5.1 and 6 (recalled)", "ISO 7096:2000, 5.5.2 and 6 (recalled)"
"""Clauses of the simulated input vibration test and of the damping test with their acceptance values."""

RECALLED = (
    "limits, test persons and details of ISO 7096 are recalled, not read in the standard: no certificate rests on them"
)


class SeatRow(NamedTuple):
    """One line of the table: a class with one driver, simulated or measured."""

    run: str
    spectral_class: Annotated[SpectralClass, Form(key="class")]
    person: str
    mass: float
    """Mass of the test person in kg."""
    mass_on_seat: float
    """Mass that rests on the seat in kg, 73.6 % of it."""
    seat: float
    limit: float
    passed: Annotated[bool, Form(key="pass")]
    clause: str
    platform: float
    """Mean weighted acceleration of the floor in m/s^2."""
    corrected: float
    """Weighted acceleration on the seat in m/s^2, corrected to the intended input: SEAT times that of the class.

    a_wS* = a_wS a_wP* / a_wP, P the platform (ISO 7096:2000, 5.5.1; recalled).
    """
    spread: float
    """Largest deviation of a run from the mean of the runs, as a share of it."""
    within_spread: bool | None
    end_stop_hits: int | None
    """Excursions beyond the end stops; None where none are stated. No acceptance value of ISO 7096 depends on it."""


class DampingTest(NamedTuple):
    """Transmissibility at resonance of a seat."""

    resonance: float
    """Frequency in Hz of the tone with the largest transmissibility."""
    transmissibility: float
    """RMS acceleration of the inert mass over that of the floor, unweighted, at that tone."""
    stroke: float
    """Peak-to-peak displacement of the floor in m."""
    frequencies: tuple[float, ...]
    transmissibilities: tuple[float, ...]


class DampingRow(NamedTuple):
    """One line of the table: the damping test of a seat, against the limit of a class."""

    run: str
    spectral_class: Annotated[SpectralClass, Form(key="class")]
    transmissibility: float
    resonance: float
    limit: float
    passed: Annotated[bool, Form(key="pass")]
    clause: str = DAMPING


class SeatFailure(NamedTuple):
    """A run that came to no result: a simulation that broke off, or measured rows that cannot be used.

    `spectral_class` is None in the damping test, and both are None where a measured run could not be assigned.
    """

    run: str
    spectral_class: Annotated[SpectralClass | None, Form(key="class")]
    person: str | None
    reason: str


class SeatTest(NamedTuple):
    """Result of a test: lines by class and driver, lines of the damping test, the damping tests behind them by run.

    It is the content of `seat_test.json`. A line of which a run is among the `failures` stands on its other runs, and
    is not passed.
    """

    rows: Annotated[tuple[SeatRow, ...], Form(key="classes")]
    damping_rows: Annotated[tuple[DampingRow, ...], Form(key="damping")]
    damping: Annotated[dict[str, DampingTest], Form(key="damping_tests")]
    notes: tuple[str, ...]
    failures: Annotated[tuple[SeatFailure, ...], Form(key="failed")] = ()
    source: str = ""
    """Name of the scenario, or of the recording's folder."""
    standard: str = "ISO 7096:2000 with ISO 10326-1:2016"
    """What the test is by."""

    def _repr_html_(self) -> str:
        return show_record(self, "source", "standard", "classes", "damping", "notes")
