"""A run driven by an unknown input: what each port does, and responses against the filters of the toy seat."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.localise.input_estimate import FAR_OFF, PORTS, Port, Reconstruction

from .toy import CHANNELS, SKIP, Diverging, add_taps, place, pose, record, respond_to_taps, weigh_stated


@pytest.fixture(scope="module")
def objective(folder):
    runs = {"first": 240, "second": 600}
    commands = {run: 0.3 + 0.2 * np.sin(np.arange(SKIP + rows) / 9.0) for run, rows in runs.items()}
    return weigh_stated(pose(record(folder, runs=runs, channels=CHANNELS, commands=commands)))


def build(objective, port, run="first", *terms):
    return Reconstruction(objective, place(objective.problem, *terms), run, port)


def padded(problem, signal):
    """Return a signal at the rows of the whole run, zero in the first second and after it."""
    rows = len(problem.recording.table("first")["floor_acceleration"])
    whole = np.zeros(rows)
    whole[SKIP : SKIP + len(signal)] = signal
    return whole


def nominal(problem):
    return problem.simulated("first", problem.nominal, ())


@pytest.mark.parametrize(
    ("block", "frame", "driver", "cell"),
    [("damper", -1, 0, 1), ("suspension", 1, 0, 0), ("cushion", -1, 1, 0), ("driver", 0, 1, 0)],
)
def test_a_force_in_a_block_pushes_frame_and_driver_and_is_seen_by_the_load_cell(objective, block, frame, driver, cell):
    problem, rig = objective.problem, build(objective, PORTS[block])
    signal = np.random.default_rng(1).standard_normal(rig.samples) * 50.0
    whole = padded(problem, signal)
    expected = frame * add_taps("frame force", whole) + driver * add_taps("driver force", whole)
    expected[CHANNELS.index("damper_force")] += cell * whole
    found = rig.simulate_with(signal) - nominal(problem)
    assert np.allclose(found, expected[:, SKIP : SKIP + rig.samples], atol=1e-9)


def test_a_motion_of_the_floor_adds_to_the_recorded_one(objective):
    rig = build(objective, PORTS["floor"])
    signal = np.random.default_rng(1).standard_normal(rig.samples)
    expected = add_taps("floor", padded(objective.problem, signal))[:, SKIP : SKIP + rig.samples]
    assert np.allclose(rig.simulate_with(signal) - nominal(objective.problem), expected, atol=1e-9)


def test_a_current_adds_to_that_of_the_coil_and_is_never_negative(objective):
    problem, rig = objective.problem, build(objective, Port(current=2.0))
    floor = problem.inputs["first"].floor
    # The coil of the toy carries what is commanded.
    assert np.allclose(rig.current, floor.command)
    signal = 0.3 * np.random.default_rng(1).standard_normal(rig.samples)
    flowing = np.maximum(floor.command[:: problem.parts] + 2.0 * padded(problem, signal), 0.0)
    assert np.any(flowing == 0.0)
    expected = add_taps("floor", floor.acceleration[:: problem.parts]) + add_taps("current", flowing)
    assert np.allclose(rig.simulate_with(signal), expected[:, SKIP : SKIP + rig.samples], atol=1e-9)


def test_a_rig_that_leaves_all_bounds_misses_by_far(objective):
    scenario = dataclasses.replace(objective.problem.scenario, effects=(Diverging(1.0),))
    problem = dataclasses.replace(objective.problem, scenario=scenario)
    rig = build(dataclasses.replace(objective, problem=problem), PORTS["suspension"])
    found = rig.simulate_with(np.zeros(rig.samples))
    assert np.array_equal(found, np.tile(FAR_OFF * problem.spread[:, None], rig.samples))


def weighted(objective, run, response):
    weights = objective.weights.weights[run]
    return weights * response[:, : weights.shape[1]]


def test_the_response_of_a_filter_is_measured_but_for_its_ends(objective):
    rig = build(objective, PORTS["floor"], "second")
    expected = weighted(objective, "second", respond_to_taps("floor", rig.samples))
    found = rig.measure_response(np.zeros(rig.samples), objective.problem.simulated("second", np.zeros(2), ()), 1)
    # Averages over bands smear the phase of the delay a little, and the first sample has no past.
    assert np.max(np.abs(found - expected)) < 0.15 * np.max(np.abs(expected))
    assert np.linalg.norm(found - expected) < 0.07 * np.linalg.norm(expected)
    # A later tap turns the phase the other way than an earlier one would.
    assert np.linalg.norm(found - expected.conj()) > 0.2 * np.linalg.norm(expected)
