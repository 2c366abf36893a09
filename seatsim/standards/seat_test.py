"""The seat test of ISO 7096, on the scenario of a seat or on a recording of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from seatsim.excitations.iso7096 import SpectralClass, acceleration_density
from seatsim.metrics.comfort import dose
from seatsim.metrics.motion import end_stop_hits
from seatsim.metrics.spectra import power_spectral_density
from seatsim.metrics.weighting import frequency_response, weight
from seatsim.recordings.recording import HEADER, Recording, load_recording
from seatsim.rig.plant import Plant
from seatsim.scenario.loading import load
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.text import join_names
from seatsim.simulation.augment import augment_plant
from seatsim.standards.seat_rows import (
    LIMITS,
    PERSONS,
    RECALLED,
    SEATED_SHARE,
    SETTLE,
    SeatFailure,
    SeatTest,
    Trial,
    doubt_runs,
    state_row,
)
from seatsim.standards.simulated_seat import assess_simulated_seats


def seat_test(
    source: str | Path,
    classes: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> SeatTest:
    """Put a seat to the test of ISO 7096: SEAT factors, damping at resonance, end stops.

    Args:
        source: a scenario, whose every variant is tested, or the folder of a recording.
        classes: spectral classes, all nine where empty.
        settings: values of the scenario by dotted key.
        progress: is called with the simulations done and all.

    Raises:
        InputError: the scenario or recording is wrong, or has no seat to test. RunError: a simulation failed.
    """
    chosen = _find_classes(classes) or tuple(LIMITS)
    if (Path(source) / HEADER).exists():
        found = _assess_recorded_seat(load_recording(source), chosen)
    else:
        found = assess_simulated_seats(load(source, settings), chosen, progress)
    return found._replace(source=Path(source).name)


def _find_classes(names: Sequence[str]) -> tuple[SpectralClass, ...]:
    """Return spectral classes by name, whatever their case.

    Raises:
        InputError: there is no such class.
    """
    known = {name.lower(): name for name in LIMITS}
    for name in names:
        if name.lower() not in known:
            raise InputError(f"no class is called '{name}'{nearest(name, LIMITS)}; permitted: {', '.join(LIMITS)}")
    return tuple(known[name.lower()] for name in names)


_NEEDED = ("floor_acceleration", "driver_acceleration")
_TRAVEL = "suspension_displacement"
_SEGMENT = 8.0
"""s; segments of the spectrum of the floor."""
_FARTHEST = 0.3
"""Largest mean deviation of a run's spectrum from that of its class, as a share of the class's power."""
_INPUT_TOLERANCE = 0.05
"""Largest deviation of the floor's weighted acceleration from that of its class (ISO 7096:2000, 5.5.1; recalled)."""
_PERSON_TOLERANCE = 5.0
"""kg; a run whose driver is farther from both test persons is of no test."""


def _assess_recorded_seat(recording: Recording, classes: Sequence[SpectralClass]) -> SeatTest:
    """Put the runs of a recording to the test of ISO 7096; the damping test is left out.

    A run is of the class whose spectrum its floor has, and of the person whose mass rests on the seat: the nominal
    `plant.driver_mass`, or what the run sets.

    Args:
        recording: of a seat, with the accelerations of floor and driver.
        classes: those that a run may be of.

    Raises:
        InputError: the recording lacks a channel, or no run of it is of a class.
    """
    nominal = recording.nominal
    plant = None if nominal.plant is None else augment_plant(nominal.effects, nominal.plant)
    if plant is None or any(name not in recording.channels for name in _NEEDED):
        raise InputError(f"{recording.folder / HEADER}: the test of a seat needs the channels {join_names(_NEEDED)}")
    groups: dict[tuple[SpectralClass, str], list[Trial]] = {}
    notes = [RECALLED, "the damping test needs tones under an inert mass, and is left out"]
    failures: list[SeatFailure] = []
    for run in recording.runs:
        try:
            table = recording.table(run)
            found, off = _nearest_class(table[_NEEDED[0]], recording.header.sample_rate, classes)
        except InputError as error:
            failures.append(SeatFailure(run, None, None, str(error)))
            continue
        mass = recording.runs[run].set.get("plant.driver_mass", plant.driver_mass) / SEATED_SHARE
        person = min(PERSONS, key=lambda name: abs(PERSONS[name] - mass))
        if off > _FARTHEST or abs(PERSONS[person] - mass) > _PERSON_TOLERANCE:
            notes.append(
                f"run {run} is left out: nearest is {found}, off by {1e2 * off:.0f} %; a person of {mass:.0f} kg"
            )
            continue
        trial = _trial(table, recording.header.sample_rate, plant)
        expected = weighted_input(found)
        if abs(trial.floor.rms / expected - 1) > _INPUT_TOLERANCE:
            notes.append(f"run {run}: its floor has {trial.floor.rms:.3g} m/s^2 weighted, {found} has {expected:.3g}")
        groups.setdefault((found, person), []).append(trial)
    if not groups:
        reasons = [*notes[2:], *(failure.reason for failure in failures)]
        raise InputError(f"{recording.folder}: no run is of a class of ISO 7096; " + "; ".join(reasons))
    name = recording.folder.resolve().name
    rows = tuple(state_row(name, *key, trials) for key, trials in sorted(groups.items()))
    return SeatTest(rows, (), {}, (*notes, *doubt_runs(rows)), tuple(failures))


def _nearest_class(floor: Array, rate: float, classes: Sequence[SpectralClass]) -> tuple[SpectralClass, float]:
    """Return the class whose spectrum is nearest to that of a floor, and how far it is, as a share of its power.

    Args:
        floor: acceleration in m/s^2, shape (N,), at least 16 s.
        rate: in Hz.
        classes: those to choose from, at least one.
    """
    frequency, density = power_spectral_density(floor, rate, 2 * round(_SEGMENT * rate / 2))
    distances = {
        each: float(np.sum(np.abs(density - wanted)) / np.sum(wanted))
        for each in classes
        for wanted in [acceleration_density(frequency, each)]
    }
    found = min(distances, key=lambda each: distances[each])
    return found, distances[found]


def weighted_input(spectral_class: SpectralClass) -> float:
    """Return the Wk-weighted RMS acceleration of a class in m/s^2, sqrt(integral G |Wk|^2 df)."""
    frequency = np.linspace(0.0, 20.0, 20001)
    power = acceleration_density(frequency, spectral_class) * np.abs(frequency_response(frequency)) ** 2
    return float(np.sqrt(np.trapezoid(power, frequency)))


def _trial(table: Mapping[str, Array], rate: float, plant: Plant) -> Trial:
    settled = round(SETTLE * rate)
    floor, driver = (dose(weight(table[name] - table[name].mean(), rate)[settled:], rate) for name in _NEEDED)
    stops = plant.end_stops if _TRAVEL in table else None
    return Trial(driver, floor, end_stop_hits(table[_TRAVEL], stops) if stops else None)
