"""The damping test of a seat: its transmissibility at resonance under an inert mass (ISO 10326-1, 10.3)."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np

from seatsim.effects.driver import Mass
from seatsim.excitations.periodic import SteppedSine
from seatsim.metrics.motion import rms
from seatsim.rig.drivers import SINGLE_MASS, Driver
from seatsim.rig.plant import Plant, natural_frequencies
from seatsim.scenario.scenario import Scenario
from seatsim.simulation.simulate import History, simulate
from seatsim.standards.iso7096 import FREQUENCY_STEP, INERT_MASS, LARGEST_STROKE, STROKE_SHARE

FADE, CYCLES, EVALUATED = 1, 12, 6
"""Periods over which a tone fades in and out, at full amplitude, and at its end that are evaluated."""


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


def run_damping_test(scenario: Scenario, plant: Plant) -> DampingTest:
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
        excitation=SteppedSine(tones, CYCLES, 0.5 * stroke),
        effects=(*scenario.effects, Mass(INERT_MASS - plant.driver_mass)),
    )
    ratios = _ratios(simulate(tested), tones)
    largest = int(np.argmax(ratios))
    return DampingTest(tones[largest], ratios[largest], stroke, tones, tuple(ratios))


def _ratios(history: History, tones: tuple[float, ...]) -> list[float]:
    ends = np.cumsum([(CYCLES + 2 * FADE) / tone for tone in tones])
    ratios = []
    for tone, end in zip(tones, ends, strict=True):
        last = round((end - FADE / tone) / history.step)
        steady = slice(last - round(EVALUATED / tone / history.step), last)
        seat, floor = (history[name][steady] for name in ("driver_acceleration", "floor_acceleration"))
        ratios.append(rms(seat) / rms(floor))
    return ratios
