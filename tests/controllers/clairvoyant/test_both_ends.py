"""The clairvoyant bracket: both ends against independent answers, and against the laws."""

import dataclasses

import numpy as np
import pytest

import seatsim
from controllers.clairvoyant import clairvoyant
from controllers.clairvoyant.bound import find_lower_bound
from controllers.clairvoyant.recursion import ForceBand
from controllers.clairvoyant.solve import find_best_run
from seatsim.metrics.comfort import weighted_rms
from seatsim.schema.errors import InputError
from seatsim.simulation.inputs import Forces
from seatsim.simulation.simulate import simulate

LAWS = {
    "H-infinity": {"controller": {"law": "static_output_feedback", "gain": [2.0, 2147.6], "sample_time": 0.005}},
    "skyhook": {"controller": {"law": "skyhook", "damping": 2000.0, "sample_time": 0.005}},
    "soft": {"controller": {"law": "constant", "current": 0.0}},
    "hard": {"controller": {"law": "constant", "current": 1.0}},
}


@pytest.fixture(scope="module")
def scenarios(kept_seat_file):
    return seatsim.load(kept_seat_file, {"excitation.duration": 2.0, "variants": LAWS})


@pytest.fixture(scope="module")
def bracket(scenarios):
    return clairvoyant(scenarios[0], [30.0**2])


def test_bound_lies_below_every_law_and_below_the_run(scenarios, bracket):
    assert (bracket.lower > 0).all()
    assert (bracket.width > 0).all()
    assert bracket.width[0] < 0.06
    for scenario in scenarios:
        metrics = seatsim.run(scenario).runs[0].metrics
        aw, x = metrics["driver_acceleration_weighted"].value, metrics["suspension_displacement_rms"].value
        assert (aw**2 + bracket.weights * x**2 > bracket.reached).all()
        assert aw > bracket.bound(x)


def test_run_is_what_the_simulation_makes_of_its_force(scenarios, bracket, band):
    scenario = scenarios[0]
    weak = scenario.damper.record._replace(c_a=0.0, c_b=0.0, alpha_a=0.0, alpha_b=0.0)
    free = dataclasses.replace(scenario, damper=dataclasses.replace(scenario.damper, record=weak))
    floor = scenario.excitation.floor(0.001, scenario.seed)
    force = np.repeat(bracket.force[0], 5)
    # The simulation takes forces as linear between samples: a step in the middle of one has the held force's impulse.
    push = -np.pad(0.5 * (force[1:] + force[:-1]), 1, mode="edge")
    history = simulate(free, floor, Forces(frame=push))
    aw = weighted_rms(history["driver_acceleration"], 1000.0)
    assert aw == pytest.approx(bracket.acceleration[0], rel=5e-3)
    assert np.sqrt(np.mean(history["suspension_displacement"] ** 2)) == pytest.approx(bracket.travel[0], rel=5e-3)
    w = np.diff(history["suspension_displacement"][::5]) / 0.005
    F, size = bracket.force[0], np.abs(w)
    assert np.min(F * w - band.c * w**2 - band.f * size) > -0.02 * np.max(F * w)
    assert np.max(np.abs(F) - band.a - band.b * size) < 5.0


def test_both_ends_meet_where_the_damper_has_no_choice(problem, dense):
    """A band about F = c w leaves a dashpot, whose criterion follows from a linear system."""
    band = ForceBand(c=800.0, f=0.0, b=800.0, a=4.0)
    H, h, free, G = dense
    F = np.linalg.solve(np.eye(problem.intervals) - band.c * G, band.c * problem.transcription.free_velocity)
    dashpot = free + F @ H @ F + 2 * h @ F
    run = find_best_run(problem, band)
    assert run.cost == pytest.approx(dashpot, rel=0.05)
    assert find_lower_bound(problem, band, run.cost).value == pytest.approx(run.cost, rel=0.05)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"effects": [{"effect": "suspension.friction", "parameters": {"force": 45.0}}]}, "without effects; leave out"),
        ({"driver.model": "iso5982"}, "driver of one mass"),
        ({"damper.parameters.f0": 100.0}, "drives instead of damping"),
        ({"excitation": {"kind": "rest", "duration": 1.0}}, "nothing moves"),
        ({"temperature": {"start": 20.0, "ambient": 20.0}}, "one temperature"),
    ],
)
def test_what_has_no_bracket(kept_seat_file, settings, said):
    [scenario] = seatsim.load(kept_seat_file, settings)
    with pytest.raises(InputError, match=said):
        clairvoyant(scenario)
