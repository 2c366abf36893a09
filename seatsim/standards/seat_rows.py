"""What ISO 7096 asks of a seat, and the lines of its test: what was found, and whether it is within the limits.

Values, persons and the damping test are *recalled*: the standard's own text was not read. The clause that each value
belongs to is that of the 2000 edition.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.excitations.iso7096 import CLASSES, SpectralClass, acceleration_density
from seatsim.metrics.comfort import SPREAD, Dose, seat_transmission
from seatsim.metrics.weighting import frequency_response
from seatsim.schema.content import Form, show_record, written
from seatsim.schema.text import join_names

ACCEPTANCE, DAMPING = "ISO 7096:2000, 5.5.1 and 6 (recalled)", "ISO 7096:2000, 5.5.2 and 6 (recalled)"
"""Clauses of the simulated input vibration test and of the damping test with their acceptance values."""

UNKNOWN_EDITION = (
    "ISO 7096:2020, 5.5.3, has a damping test of its own for active and semi-active suspensions, which is not known"
    " here: the damping test is that for passive ones, with the law at work"
)
RECALLED = (
    "limits, test persons and details of ISO 7096 are recalled, not read in the standard: no certificate rests on them"
)


PERSONS = {"light": 55.0, "heavy": 98.0}
"""Mass of the two test persons in kg: 52 to 55 and 98 to 103 are permitted."""

SEATED_SHARE = 0.736
"""Share of a person's mass that rests on the seat, the feet on the floor (Boileau and Rakheja 1998; recalled)."""


class Trial(NamedTuple):
    """One simulated run: doses at driver and floor, hits of the end stops (None where none are stated)."""

    driver: Dose
    floor: Dose
    hits: int | None


class SeatRow(NamedTuple):
    """One line of the table: a class with one driver, simulated or measured."""

    run: str
    spectral_class: Annotated[SpectralClass, Form(key="class")]
    person: str
    mass: float
    """Mass of the test person in kg, of which 73.6 % rest on the seat."""
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

    @property
    @written()
    def mass_on_seat(self) -> float:
        """Mass that rests on the seat in kg."""
        return SEATED_SHARE * self.mass


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
    clause: str


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

    @property
    @written()
    def standard(self) -> str:
        """What the test is by."""
        return "ISO 7096:2000 with ISO 10326-1:2016"

    @property
    @written()
    def recalled(self) -> str:
        """Which figures were not read in the standard."""
        return RECALLED

    def _repr_html_(self) -> str:
        return show_record(self, "source", "standard", "classes", "damping", "notes")


def state_row(
    run: str, spectral_class: SpectralClass, person: str, trials: Sequence[Trial], is_whole: bool = True
) -> SeatRow:
    """Return the line of a class and driver from its runs, at least one; it is only passed where it `is_whole`."""
    found = seat_transmission([trial.driver for trial in trials], [trial.floor for trial in trials])
    limit = CLASSES[spectral_class].seat
    hits = [trial.hits for trial in trials if trial.hits is not None]
    return SeatRow(
        run=run,
        spectral_class=spectral_class,
        person=person,
        mass=PERSONS[person],
        seat=found.rms,
        limit=limit,
        passed=bool(found.rms <= limit) and is_whole,
        clause=ACCEPTANCE,
        platform=sum(trial.floor.rms for trial in trials) / len(trials),
        corrected=found.rms * weighted_input(spectral_class),
        spread=found.spread,
        within_spread=found.within_spread,
        end_stop_hits=sum(hits) if hits else None,
    )


def weighted_input(spectral_class: SpectralClass) -> float:
    """Return the Wk-weighted RMS acceleration of a class in m/s^2, sqrt(integral G |Wk|^2 df)."""
    frequency = np.linspace(0.0, 20.0, 20001)
    power = acceleration_density(frequency, spectral_class) * np.abs(frequency_response(frequency)) ** 2
    return float(np.sqrt(np.trapezoid(power, frequency)))


def state_damping_row(run: str, spectral_class: SpectralClass, found: DampingTest) -> DampingRow:
    """Return the line of the damping test of a seat against the limit of a class."""
    limit = CLASSES[spectral_class].transmissibility
    passed = bool(found.transmissibility <= limit)
    return DampingRow(run, spectral_class, found.transmissibility, found.resonance, limit, passed, DAMPING)


def doubt_runs(rows: Sequence[SeatRow]) -> list[str]:
    """Return a sentence on the lines whose runs are too few, or too far apart, for a result."""
    few = [_name(row) for row in rows if row.within_spread is None]
    apart = [_name(row) for row in rows if row.within_spread is False]
    found = [f"fewer than three runs of {join_names(few)}"] if few else []
    found += [f"runs of {join_names(apart)} differ from their mean by more than {SPREAD:.0%}"] if apart else []
    return [f"{sentence}: ISO 10326-1, 10.2.1, asks for three within {SPREAD:.0%}" for sentence in found]


def _name(row: SeatRow) -> str:
    return f"{row.run}, {row.spectral_class}, {row.mass:g} kg"
