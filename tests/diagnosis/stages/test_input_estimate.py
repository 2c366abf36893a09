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
