"""The seat test of ISO 7096, on a recording of a seat or on the scenario of one.

A simulated seat is tested with two drivers in every class, in three runs each, and with tones under an inert mass.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from seatsim.effects.seat import Mass
from seatsim.excitations.iso7096 import CLASSES, Iso7096, SpectralClass, acceleration_density
from seatsim.excitations.periodic import SteppedSine
from seatsim.metrics.comfort import RUNS, SPREAD, Dose, dose, seat_transmission
from seatsim.metrics.motion import end_stop_hits, rms
from seatsim.metrics.spectra import power_spectral_density
from seatsim.metrics.weighting import frequency_response, weight
from seatsim.recordings.recording import HEADER, Recording, load_recording
from seatsim.rig.drivers import SINGLE_MASS, Driver
from seatsim.rig.plant import Plant, natural_frequencies
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, RunError, permit
from seatsim.schema.registry import specification_of
from seatsim.schema.text import join_names
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.simulate import simulate
from seatsim.standards.seat_rows import ACCEPTANCE, RECALLED, DampingRow, DampingTest, SeatFailure, SeatRow, SeatTest

INERT_MASS = 75.0
"""Mass on the seat in the damping test in kg (ISO 10326-1:2016, 10.3)."""
_STROKE_SHARE, _LARGEST_STROKE = 0.4, 0.05
"""Peak-to-peak motion of the floor in the damping test: this share of the travel, but no more than 50 mm (recalled)."""
_FREQUENCY_STEP = 0.05
"""Hz between two tones of the damping test (recalled); they reach from half to twice the resonance expected."""
_SETTLE = 2.0
"""s; beginning of a run that is left out, while the floor fades in."""
_INERT = "inert mass"
"""What sits on the seat in the damping test, where others have a person."""
_DURATION = 60.0
"""s; length of each run that is evaluated."""

_UNKNOWN_EDITION = (
    "ISO 7096:2020, 5.5.3, has a damping test of its own for active and semi-active suspensions, which is not known"
    " here: the damping test is that for passive ones, with the law at work"
)
_PERSONS = {"light": 55.0, "heavy": 98.0}
"""Mass of the two test persons in kg: 52 to 55 and 98 to 103 are permitted."""

SEATED_SHARE = 0.736
"""Share of a person's mass that rests on the seat, the feet on the floor (Boileau and Rakheja 1998; recalled)."""


class _Trial(NamedTuple):
    """One simulated run: doses at driver and floor, hits of the end stops (None where none are stated)."""

    driver: Dose
    floor: Dose
    hits: int | None


_Progress = Callable[[int, int], None]
_Result = TypeVar("_Result", _Trial, DampingTest)


def seat_test(
    source: str | Path,
    classes: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    progress: _Progress = lambda done, of: None,
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
    chosen = _find_classes(classes) or tuple(CLASSES)
    if (Path(source) / HEADER).exists():
        found = _assess_recorded_seat(load_recording(source), chosen)
    else:
        found = _assess_simulated_seats(load(source, settings), chosen, progress)
    return found._replace(source=Path(source).name)


def _find_classes(names: Sequence[str]) -> tuple[SpectralClass, ...]:
    """Return spectral classes by name, whatever their case.

    Raises:
        InputError: there is no such class.
    """
    known = {name.lower(): name for name in CLASSES}
    for name in names:
        if name.lower() not in known:
            raise InputError(f"no class is called '{name}'{permit(name, CLASSES)}")
    return tuple(known[name.lower()] for name in names)


_NEEDED = ("driver_acceleration", "floor_acceleration")
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
        problem = f"{recording.folder / HEADER}: the test of a seat needs the channels {join_names(_NEEDED[::-1])}"
        raise InputError(problem)
    groups: dict[tuple[SpectralClass, str], list[_Trial]] = {}
    notes = [RECALLED, "the damping test needs tones under an inert mass, and is left out"]
    failures: list[SeatFailure] = []
    for run in recording.runs:
        try:
            table = recording.table(run)
            found, off = _nearest_class(table[_NEEDED[1]], recording.header.sample_rate, classes)
        except InputError as error:
            failures.append(SeatFailure(run, None, None, str(error)))
            continue
        mass = recording.runs[run].set.get("plant.driver_mass", plant.driver_mass) / SEATED_SHARE
        person = min(_PERSONS, key=lambda name: abs(_PERSONS[name] - mass))
        if off > _FARTHEST or abs(_PERSONS[person] - mass) > _PERSON_TOLERANCE:
            text = f"run {run} is left out: nearest is {found}, off by {1e2 * off:.0f} %; a person of {mass:.0f} kg"
            notes.append(text)
            continue
        swinging = table | {name: table[name] - table[name].mean() for name in _NEEDED}
        trial = _evaluate(swinging, recording.header.sample_rate, plant.end_stops if _TRAVEL in table else None)
        expected = weighted_input(found)
        if abs(trial.floor.rms / expected - 1) > _INPUT_TOLERANCE:
            notes.append(f"run {run}: its floor has {trial.floor.rms:.3g} m/s^2 weighted, {found} has {expected:.3g}")
        groups.setdefault((found, person), []).append(trial)
    if not groups:
        reasons = [*notes[2:], *(failure.reason for failure in failures)]
        raise InputError(f"{recording.folder}: no run is of a class of ISO 7096; " + "; ".join(reasons))
    name = recording.folder.resolve().name
    rows = tuple(_state_row(name, *key, trials) for key, trials in sorted(groups.items()))
    return SeatTest(rows, (), {}, (*notes, *_doubt_runs(rows)), tuple(failures))


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


def _evaluate(signals: Mapping[str, Array], rate: float, stops: tuple[float, float] | None) -> _Trial:
    """Return the doses of a run at a rate in Hz, without its beginning, and its hits of the end stops."""
    settled = round(_SETTLE * rate)
    driver, floor = (dose(weight(signals[name], rate)[settled:], rate) for name in _NEEDED)
    return _Trial(driver, floor, end_stop_hits(signals[_TRAVEL], stops) if stops else None)


def _assess_simulated_seats(
    scenarios: Sequence[Scenario], classes: Sequence[SpectralClass], progress: _Progress
) -> SeatTest:
    """Put the seats of scenarios to the test of ISO 7096, each in three runs a class and driver.

    Drivers differ from the scenario's by an effect on the mass, so that a law stays designed for the mass that its file
    states. The three runs differ in the random phases of the floor.

    Args:
        scenarios: seats with their control; their excitation is replaced.
        classes: spectral classes.
        progress: is called with the simulations done and all.

    Raises:
        InputError: a scenario has no seat, or a law that only replays.
        RunError: no simulation could be carried to its end.
    """
    seats = {scenario.title: _seat_of(scenario) for scenario in scenarios}
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        trials = {
            (title, each, person): [pool.submit(_run_trial, seat, each, person, seed) for seed in range(RUNS)]
            for title, seat in seats.items()
            for each in classes
            for person in _PERSONS
        }
        damping = {title: pool.submit(_run_damping_test, seat.scenario, seat.plant) for title, seat in seats.items()}
        every: list[Future[Any]] = [*(future for futures in trials.values() for future in futures), *damping.values()]
        for done, _ in enumerate(as_completed(every), 1):
            progress(done, len(every))
    failures: list[SeatFailure] = []
    results = {key: _finished(runs, (*key,), failures) for key, runs in trials.items()}
    ended = {title: _finished([future], (title, None, _INERT), failures) for title, future in damping.items()}
    tested = {title: found[0] for title, found in ended.items() if found}
    rows = tuple(_state_row(*key, found, len(found) == RUNS) for key, found in results.items() if found)
    if not rows and not tested:
        raise RunError(failures[0].reason)
    return SeatTest(
        rows=rows,
        damping_rows=tuple(
            _state_damping_row(title, each, found) for title, found in tested.items() for each in classes
        ),
        damping=tested,
        notes=(*_notes(seats), *_doubt_runs(rows)),
        failures=tuple(dict.fromkeys(failures)),
    )


def _finished(
    futures: Sequence[Future[_Result]], place: tuple[str, SpectralClass | None, str | None], failures: list[SeatFailure]
) -> list[_Result]:
    """Return the results of the simulations that were carried to their end; the others are put among the failures."""
    found = []
    for future in futures:
        try:
            found.append(future.result())
        except RunError as error:
            failures.append(SeatFailure(*place, str(error)))
    return found


class _Seat(NamedTuple):
    scenario: Scenario
    plant: Plant


def _seat_of(scenario: Scenario) -> _Seat:
    if scenario.plant is None or scenario.control is None:
        raise InputError(f"{scenario.title}: a damper bench has no seat to test; give the scenario of a seat")
    if specification_of(type(scenario.control.law)).replays:
        problem = f"{scenario.title}: its law replays a recording; state the law of the seat, or test the recording"
        raise InputError(problem)
    # The test has drivers of its own.
    effects = tuple(effect for effect in scenario.effects if not isinstance(effect, Mass))
    return _Seat(dataclasses.replace(scenario, effects=effects), augment_plant(effects, scenario.plant))


def _run_trial(seat: _Seat, spectral_class: SpectralClass, person: str, seed: int) -> _Trial:
    change = SEATED_SHARE * _PERSONS[person] - seat.plant.driver_mass
    excitation, effects = Iso7096(spectral_class, _SETTLE + _DURATION), (*seat.scenario.effects, Mass(change))
    history = simulate(dataclasses.replace(seat.scenario, excitation=excitation, seed=seed, effects=effects))
    signals = {name: history[name] for name in (*_NEEDED, _TRAVEL)}
    return _evaluate(signals, 1 / history.step, seat.plant.end_stops)


def _notes(seats: Mapping[str, _Seat]) -> Iterator[str]:
    yield RECALLED
    yield _UNKNOWN_EDITION
    without = [title for title, seat in seats.items() if seat.plant.end_stops is None]
    if without:
        yield f"no end stops are stated for {join_names(without)}, and none are checked; state plant.travel"


_FADE, _CYCLES, _EVALUATED = 1, 12, 6
"""Periods over which a tone fades in and out, at full amplitude, and at its end that are evaluated."""


def _run_damping_test(scenario: Scenario, plant: Plant) -> DampingTest:
    """Drive a seat through tones about its resonance and return the largest transmissibility.

    The control law acts as the scenario says.

    Raises:
        RunError: the simulation could not be carried to its end.
    """
    stroke = min(_STROKE_SHARE * (plant.travel[1] - plant.travel[0]), _LARGEST_STROKE)
    expected = natural_frequencies(plant._replace(driver_mass=INERT_MASS))[0]
    tones = tuple(np.arange(0.5 * expected, 2.0 * expected + 0.5 * _FREQUENCY_STEP, _FREQUENCY_STEP).tolist())
    tested = dataclasses.replace(
        scenario,
        driver=Driver(SINGLE_MASS),
        excitation=SteppedSine(tones, _CYCLES, 0.5 * stroke),
        effects=(*scenario.effects, Mass(INERT_MASS - plant.driver_mass)),
    )
    history, ratios = simulate(tested), []
    for tone, end in zip(tones, np.cumsum([(_CYCLES + 2 * _FADE) / tone for tone in tones]), strict=True):
        last = round((end - _FADE / tone) / history.step)
        steady = slice(last - round(_EVALUATED / tone / history.step), last)
        seat, floor = (history[name][steady] for name in _NEEDED)
        ratios.append(rms(seat) / rms(floor))
    largest = int(np.argmax(ratios))
    return DampingTest(tones[largest], ratios[largest], stroke, tones, tuple(ratios))


def _state_row(
    run: str, spectral_class: SpectralClass, person: str, trials: Sequence[_Trial], is_whole: bool = True
) -> SeatRow:
    """Return the line of a class and driver from its runs, at least one; it is only passed where it `is_whole`."""
    found = seat_transmission([trial.driver for trial in trials], [trial.floor for trial in trials])
    limit = CLASSES[spectral_class].seat
    hits = [trial.hits for trial in trials if trial.hits is not None]
    return SeatRow(
        run=run,
        spectral_class=spectral_class,
        person=person,
        mass=_PERSONS[person],
        mass_on_seat=SEATED_SHARE * _PERSONS[person],
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


def _state_damping_row(run: str, spectral_class: SpectralClass, found: DampingTest) -> DampingRow:
    """Return the line of the damping test of a seat against the limit of a class."""
    limit = CLASSES[spectral_class].transmissibility
    passed = bool(found.transmissibility <= limit)
    return DampingRow(run, spectral_class, found.transmissibility, found.resonance, limit, passed)


def _doubt_runs(rows: Sequence[SeatRow]) -> list[str]:
    """Return a sentence on the lines whose runs are too few, or too far apart, for a result."""
    few = [_name(row) for row in rows if row.within_spread is None]
    apart = [_name(row) for row in rows if row.within_spread is False]
    found = [f"fewer than three runs of {join_names(few)}"] if few else []
    found += [f"runs of {join_names(apart)} differ from their mean by more than {SPREAD:.0%}"] if apart else []
    return [f"{sentence}: ISO 10326-1, 10.2.1, asks for three within {SPREAD:.0%}" for sentence in found]


def _name(row: SeatRow) -> str:
    return f"{row.run}, {row.spectral_class}, {row.mass:g} kg"
