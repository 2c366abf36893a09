"""The block that an unknown input acts in is found, whatever its course."""

import dataclasses
import shutil

import numpy as np
import pytest

from seatsim.diagnosis.localise.hypotheses import evaluate_hypotheses
from seatsim.diagnosis.localise.input_estimate import estimate_nonrepeatable_force
from seatsim.diagnosis.localise.reconstruction import PORTS
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.parameters import Parameters
from seatsim.simulation.inputs import Forces
from seatsim.simulation.simulate import simulate

from ..faulty_recordings import blurred, limited, rewrite, stepped, with_play
from .posed import pose


@pytest.fixture(scope="module")
def posed(sound):
    return pose(sound)


def course(samples, rate):
    time = np.arange(samples) / rate
    return np.sin(2 * np.pi * 2.3 * time) + np.sin(2 * np.pi * 5.1 * time) * np.sign(np.sin(2 * np.pi * 0.9 * time))


def with_input(posed, block, course=course):
    """Return the problem with the recording of a rig that has an input more, and the stated noise."""
    port, rng, measured = PORTS[block], np.random.default_rng(3), {}
    for run in posed.runs:
        floor = posed.inputs[run].floor
        extra = 20.0 * course(len(floor.acceleration), 1.0 / floor.step)
        forces = Forces(port.frame_force * extra, port.driver_force * extra)
        true = posed.simulated(run, posed.nominal, (), posed.inputs[run]._replace(forces=forces))
        parts = round(1.0 / posed.recording.header.sample_rate / floor.step)
        cell = extra[::parts][posed.skip : posed.skip + true.shape[1]]
        true[posed.channels.index("damper_force")] += port.load_cell_error * cell
        measured[run] = true + posed.noise[:, None] * rng.standard_normal(true.shape)
    return dataclasses.replace(posed, measured=measured)


def likeliest(posed):
    objective = Objective(posed, weigh_noise(posed))
    nominal = objective.evaluate([Parameters(posed.nominal)])[0]
    found = evaluate_hypotheses(objective, objective.linearise_nuisances(nominal))
    return min(found, key=lambda block: found[block].negative_log_evidence), found


@pytest.mark.parametrize("block", ["damper", "suspension", "cushion", "driver"])
def test_a_force_in_a_block_is_placed_there(posed, block):
    assert likeliest(with_input(posed, block))[0] == block


def test_a_slow_force_is_no_wandering_zero_of_the_floor(posed):
    slow = with_input(posed, "suspension", lambda samples, rate: np.sin(2 * np.pi * 0.2 / rate * np.arange(samples)))
    assert likeliest(slow)[0] in ("suspension", "driver")


def test_a_current_that_the_command_does_not_predict_is_the_coils(posed):
    rng, measured = np.random.default_rng(3), {}
    for run in posed.runs:
        floor = posed.inputs[run].floor
        flowing = simulate(posed.augmented(posed.nominal, ()), floor, carry_all_effects=True)["coil_current"]
        without_small = np.where(flowing > 0.3, flowing - 0.2, 0.0)
        logged = posed.inputs[run]._replace(floor=floor._replace(command=None, coil_current=without_small))
        true = posed.simulated(run, posed.nominal, (), logged)
        measured[run] = true + posed.noise[:, None] * rng.standard_normal(true.shape)
    assert likeliest(dataclasses.replace(posed, measured=measured))[0] == "coil"


def test_a_wrong_log_of_the_current_is_the_sensors(posed):
    measured, k = {run: values.copy() for run, values in posed.measured.items()}, posed.channels.index("coil_current")
    for values in measured.values():
        values[k] = np.where(values[k] > 0.3, values[k] - 0.2, 0.0)
    best, found = likeliest(dataclasses.replace(posed, measured=measured))
    assert best == "sensor" and found[best].channel == "coil_current"


def test_without_a_load_cell_damper_and_suspension_are_one(posed):
    kept = [k for k, name in enumerate(posed.channels) if name != "damper_force"]
    channels = tuple(posed.channels[k] for k in kept)
    shaken = with_input(posed, "suspension")
    measured = {run: values[kept] for run, values in shaken.measured.items()}
    best, found = likeliest(dataclasses.replace(shaken, channels=channels, measured=measured))
    assert best == "damper" and found["suspension"].negative_log_evidence == found["damper"].negative_log_evidence


def test_an_error_of_one_channel_is_the_sensors(posed):
    measured = {run: values.copy() for run, values in posed.measured.items()}
    k = posed.channels.index("driver_acceleration")
    for values in measured.values():
        values[k] = np.clip(values[k], -posed.spread[k], posed.spread[k])
    best, found = likeliest(dataclasses.replace(posed, measured=measured))
    assert best == "sensor"
    assert found["sensor"].quantity == "error of driver_acceleration"


@pytest.mark.parametrize("fault", [stepped, with_play, limited])
def test_a_floor_that_only_its_sensor_sees_rest_is_the_sensors(sound, tmp_path, fault):
    copy = shutil.copytree(sound, tmp_path / "copy")
    rewrite(copy, blurred(fault))
    best, found = likeliest(pose(copy))
    assert best == "sensor"
    assert found[best].channel == "floor_acceleration"
    assert "floor" not in found


def repeated(posed, newtons):
    """Return the problem with a run and its repeat, between which a random force on the frame differs."""
    first, second = posed.runs
    rng, measured = np.random.default_rng(5), {}
    for run in posed.runs:
        push = Forces(newtons * rng.standard_normal(len(posed.inputs[first].floor.acceleration)))
        true = posed.simulated(first, posed.nominal, (), posed.inputs[first]._replace(forces=push))
        measured[run] = true + posed.noise[:, None] * rng.standard_normal(true.shape)
    runs = posed.recording.runs | {second: posed.recording.runs[second]._replace(repeat_of=first)}
    recording, inputs = dataclasses.replace(posed.recording, runs=runs), dict.fromkeys(posed.runs, posed.inputs[first])
    return dataclasses.replace(posed, measured=measured, inputs=inputs, recording=recording)


def test_a_force_that_does_not_repeat_is_found_for_every_run(posed):
    found = []
    for newtons in (0.0, 30.0):
        problem = repeated(posed, newtons)
        objective = Objective(problem, weigh_noise(problem))
        forces = estimate_nonrepeatable_force(objective, objective.evaluate([Parameters(problem.nominal)])[0])
        assert set(forces) == set(problem.runs)
        found.append(np.std(forces[problem.runs[0]]))
    assert found[1] > 3.0 * found[0]


def test_without_repeats_no_force_is_looked_for(posed):
    objective = Objective(posed, weigh_noise(posed))
    assert estimate_nonrepeatable_force(objective, objective.evaluate([Parameters(posed.nominal)])[0]) is None
