"""Estimates of unknown inputs against signals that were planted, and against their formulas."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.localise.input_estimate import (
    PORTS,
    Port,
    Reconstruction,
    estimate_current,
    estimate_input,
    estimate_nonrepeatable_force,
    respond_to_error,
)

from .toy import CHANNELS, SKIP, evaluate_nominal, place, plant, pose, record, slow_signal, weigh_stated

SAMPLES = 400
LOUD = 1e-3
"""Noise under which a planted signal is nearly all that is seen."""


def make_objective(folder, noise=0.05, channels=CHANNELS[:3], **kept):
    runs = {"first": SAMPLES, "second": 300}
    return weigh_stated(pose(record(folder, runs=runs, channels=channels, noise=noise, **kept)))


@pytest.mark.parametrize("block", ["suspension", "floor"])
def test_a_planted_signal_is_recovered_to_within_the_noise(folder, block):
    signal = slow_signal(SAMPLES, 0.5 if block == "floor" else 40.0)
    objective = plant(make_objective(folder, LOUD), PORTS[block], {"first": signal})
    found = estimate_input(objective, evaluate_nominal(objective), "first", PORTS[block])
    assert found.signal.shape == (SAMPLES,)
    assert np.sqrt(np.mean((found.signal - signal) ** 2)) < 0.03 * np.std(signal)


def test_what_is_noise_alone_needs_no_input(folder):
    objective, port = make_objective(folder), PORTS["suspension"]
    strong = plant(objective, port, {"first": slow_signal(SAMPLES, 40.0)})
    none, some = (estimate_input(each, evaluate_nominal(each), "first", port).signal for each in (objective, strong))
    assert np.std(none) < 0.03 * np.std(some)


def with_current(folder, logged_more):
    rows = SKIP + SAMPLES
    command = 0.4 + 0.2 * np.sin(np.arange(rows) / 7.0)
    objective = make_objective(folder, 0.01, CHANNELS, commands={"first": command, "second": command[: SKIP + 300]})
    measured = {run: values.copy() for run, values in objective.problem.measured.items()}
    measured["first"][4] += logged_more
    return dataclasses.replace(objective, problem=dataclasses.replace(objective.problem, measured=measured))


def test_a_current_is_what_was_logged_beyond_that_of_the_simulated_coil(folder):
    logged = slow_signal(SAMPLES, 0.05)
    objective = with_current(folder, logged)
    nominal = evaluate_nominal(objective)
    found = estimate_current(objective, nominal, "first")
    assert np.std(found.signal - logged) < 0.1 * np.std(logged)
    assert np.array_equal(found.response, respond_to_error(objective.weights.weights["first"], 4))
    # What the logged current does not explain of the other channels stays, and the log itself is what is explained.
    rig = Reconstruction(objective, place(objective.problem), "first", Port(current=1.0))
    assert np.allclose(found.residuals[:4], rig.attempt(found.signal).residuals[:4])
    assert np.array_equal(found.residuals[4], nominal.whitened["first"][4])


def test_what_a_repeat_answers_to_a_floor_of_its_own_is_no_disturbance(folder):
    own = np.random.default_rng(5).standard_normal(SKIP + SAMPLES)
    runs = {"first": own + np.random.default_rng(6).standard_normal(len(own)), "again": own}
    recording = record(folder, runs=runs, channels=CHANNELS[:3], noise=LOUD, repeats={"again": "first"})
    objective = weigh_stated(pose(recording))
    nominal = evaluate_nominal(objective)
    assert np.std(objective.problem.measured["first"] - objective.problem.measured["again"]) > 0.5
    assert np.std(estimate_nonrepeatable_force(objective, nominal)["again"]) < 0.01


def test_without_repeats_of_the_same_length_there_is_no_such_force(folder):
    objective = make_objective(folder)
    nominal = evaluate_nominal(objective)
    assert estimate_nonrepeatable_force(objective, nominal) is None
    unequal = make_objective(folder, repeats={"second": "first"})
    assert estimate_nonrepeatable_force(unequal, nominal) is None


def repeat(folder, forces, noise=LOUD):
    """Return an objective with a run, its repeat and a third run, and the nominal rig; forces act on the frame."""
    floor = np.random.default_rng(4).standard_normal(SKIP + SAMPLES)
    runs = {"first": floor, "other": 250, "again": floor}
    recording = record(folder, runs=runs, channels=CHANNELS[:3], noise=noise, repeats={"again": "first"})
    objective = weigh_stated(pose(recording))
    objective = plant(objective, PORTS["suspension"], forces)
    return objective, evaluate_nominal(objective)


def test_a_force_by_which_a_run_and_its_repeat_differ_is_half_of_the_difference_in_power(folder):
    forces = {"first": slow_signal(SAMPLES, 5.0, 1), "again": slow_signal(SAMPLES, 5.0, 2)}
    found = estimate_nonrepeatable_force(*repeat(folder, forces))["first"]
    expected = (forces["first"] - forces["again"]) / np.sqrt(2.0)
    assert np.corrcoef(found, expected)[0, 1] > 0.99
    # What the filter takes off is given back by the factor `regained` of 1.2.
    assert 1.0 < np.std(found) / np.std(expected) < 1.3
