"""The block that an unknown input acts in is found, whatever its course."""

import dataclasses
import shutil

import numpy as np
import pytest

from seatsim.diagnosis.localise.localisation import evaluate_hypotheses
from seatsim.diagnosis.localise.reconstruction import PORTS
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Objective, Parameters
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


@pytest.mark.parametrize("fault", [stepped, with_play, limited])
def test_a_floor_that_only_its_sensor_sees_rest_is_the_sensors(sound, tmp_path, fault):
    copy = shutil.copytree(sound, tmp_path / "copy")
    rewrite(copy, blurred(fault))
    best, found = likeliest(pose(copy))
    assert best == "sensor"
    assert found[best].channel == "floor_acceleration"
    assert "floor" not in found
