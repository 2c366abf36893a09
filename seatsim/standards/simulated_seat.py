"""The seat test of ISO 7096 on simulated seats: two drivers in nine classes, three runs each, and the damping test."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from typing import NamedTuple, TypeVar

import numpy as np

from seatsim.effects.seat import Mass
from seatsim.excitations.iso7096 import Iso7096, SpectralClass
from seatsim.excitations.periodic import SteppedSine
from seatsim.metrics.comfort import RUNS, dose
from seatsim.metrics.motion import end_stop_hits, rms
from seatsim.metrics.weighting import weight
from seatsim.rig.drivers import SINGLE_MASS, Driver
from seatsim.rig.plant import Plant, natural_frequencies
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.registry import specification_of
from seatsim.schema.text import join_names
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.result import History
from seatsim.simulation.simulate import simulate
from seatsim.standards.seat_rows import (
    FREQUENCY_STEP,
    INERT_MASS,
    LARGEST_STROKE,
    PERSONS,
    RECALLED,
    SEATED_SHARE,
    SETTLE,
    STROKE_SHARE,
    DampingTest,
    SeatFailure,
    SeatTest,
    Trial,
    doubt_runs,
    state_damping_row,
    state_row,
)

_INERT = "inert mass"
"""What sits on the seat in the damping test, where others have a person."""
_DURATION = 60.0
"""s; length of each run that is evaluated."""

_Count = Callable[[int, int], None]
_Result = TypeVar("_Result", Trial, DampingTest)


def assess_simulated_seats(
    scenarios: Sequence[Scenario], classes: Sequence[SpectralClass], progress: _Count = lambda done, of: None
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
            for person in PERSONS
        }
        damping = {title: pool.submit(_run_damping_test, seat.scenario, seat.plant) for title, seat in seats.items()}
        _count([*(future for futures in trials.values() for future in futures), *damping.values()], progress)
    failures: list[SeatFailure] = []
    done = {key: _finished(runs, (*key,), failures) for key, runs in trials.items()}
    ended = {title: _finished([future], (title, None, _INERT), failures) for title, future in damping.items()}
    tested = {title: found[0] for title, found in ended.items() if found}
    rows = tuple(state_row(*key, found, len(found) == RUNS) for key, found in done.items() if found)
    if not rows and not tested:
        raise RunError(failures[0].reason)
    return SeatTest(
        rows=rows,
        damping_rows=tuple(
            state_damping_row(title, each, found) for title, found in tested.items() for each in classes
        ),
        damping=tested,
        notes=(*_notes(seats), *doubt_runs(rows)),
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
        raise InputError(
            f"{scenario.title}: its law replays a recording; state the law of the seat, or test the recording"
        )
    # The test has drivers of its own.
    effects = tuple(effect for effect in scenario.effects if not isinstance(effect, Mass))
    return _Seat(dataclasses.replace(scenario, effects=effects), augment_plant(effects, scenario.plant))


def _run_trial(seat: _Seat, spectral_class: SpectralClass, person: str, seed: int) -> Trial:
    change = SEATED_SHARE * PERSONS[person] - seat.plant.driver_mass
    history = simulate(
        dataclasses.replace(
            seat.scenario,
            excitation=Iso7096(spectral_class, SETTLE + _DURATION),
            seed=seed,
            effects=(*seat.scenario.effects, Mass(change)),
        )
    )
    rate, settled = 1 / history.step, round(SETTLE / history.step)
    driver, floor = (
        dose(weight(history[name], rate)[settled:], rate) for name in ("driver_acceleration", "floor_acceleration")
    )
    stops = seat.plant.end_stops
    return Trial(driver, floor, end_stop_hits(history["suspension_displacement"], stops) if stops else None)


def _count(futures: Sequence[Future[Trial] | Future[DampingTest]], progress: _Count) -> None:
    for done, _ in enumerate(as_completed(futures), 1):
        progress(done, len(futures))


def _notes(seats: Mapping[str, _Seat]) -> Iterator[str]:
    yield RECALLED
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
    stroke = min(STROKE_SHARE * (plant.travel[1] - plant.travel[0]), LARGEST_STROKE)
    expected = natural_frequencies(plant._replace(driver_mass=INERT_MASS))[0]
    tones = tuple(np.arange(0.5 * expected, 2.0 * expected + 0.5 * FREQUENCY_STEP, FREQUENCY_STEP).tolist())
    tested = dataclasses.replace(
        scenario,
        driver=Driver(SINGLE_MASS),
        excitation=SteppedSine(tones, _CYCLES, 0.5 * stroke),
        effects=(*scenario.effects, Mass(INERT_MASS - plant.driver_mass)),
    )
    ratios = _ratios(simulate(tested), tones)
    largest = int(np.argmax(ratios))
    return DampingTest(tones[largest], ratios[largest], stroke, tones, tuple(ratios))


def _ratios(history: History, tones: tuple[float, ...]) -> list[float]:
    ends = np.cumsum([(_CYCLES + 2 * _FADE) / tone for tone in tones])
    ratios = []
    for tone, end in zip(tones, ends, strict=True):
        last = round((end - _FADE / tone) / history.step)
        steady = slice(last - round(_EVALUATED / tone / history.step), last)
        seat, floor = (history[name][steady] for name in ("driver_acceleration", "floor_acceleration"))
        ratios.append(rms(seat) / rms(floor))
    return ratios
