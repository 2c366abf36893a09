"""Candidate experiments: their order, their words, what they do to floor, current, warmth, mass and sensors."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.design.candidate_experiments import EXCITATIONS, excite, list_candidate_experiments
from seatsim.rig.control import LAWS
from seatsim.scenario.scenario import Control
from seatsim.simulation.inputs import BenchInputs

from .toy import CHANNELS, RATE, pose, record

INTERVENTIONS = ["zero_current", "warm_up", "locked_seat", "added_mass"]
EXCITED = ["bump", "sweep", "large_slow_sine", "very_slow_sine", "current_steps"]


@pytest.fixture(scope="module")
def seat(folder):
    """A seat whose coil takes 2 A, with all channels but the current's and the load cell's."""
    commands = {"first": np.full(440, 0.2), "second": np.full(500, 0.4)}
    problem = pose(record(folder, runs={"first": 240, "second": 300}, channels=CHANNELS[:3], commands=commands))
    coil = problem.scenario.coil._replace(max_current=2.0)
    return dataclasses.replace(problem, scenario=dataclasses.replace(problem.scenario, coil=coil))


@pytest.fixture(scope="module")
def bench(seat):
    """The same as a bench, with the displacement of a damper."""
    recording = dataclasses.replace(seat.recording, header=seat.recording.header._replace(rig="damper_bench"))
    motion = np.sin(np.arange(400) / 20.0)
    inputs = BenchInputs(1.0 / RATE, motion, current_command=np.full(400, 0.4), damper_temperature=np.full(400, 30.0))
    return dataclasses.replace(seat, recording=recording, inputs={"first": inputs}, channels=("damper_force",))


def by_name(problem):
    return {each.name: each for each in list_candidate_experiments(problem)}


def test_the_cheapest_come_first_and_a_sensor_is_added_where_it_lacks(seat):
    assert list(by_name(seat)) == [*EXCITED, "coil_current", *INTERVENTIONS, "load_cell"]
    added = {name: each.added_sensors for name, each in by_name(seat).items() if each.added_sensors}
    assert added == {"coil_current": ("coil_current",), "load_cell": ("damper_force",)}
    full = dataclasses.replace(seat, channels=CHANNELS)
    assert list(by_name(full)) == [*EXCITED, *INTERVENTIONS]


def test_a_switched_current_is_off_and_nearly_full_every_quarter_of_a_second(seat):
    found = by_name(seat)["current_steps"]
    assert found.scenario["controller"] == {"law": "on_off_skyhook", "on": 1.8}
    for candidate in (found, by_name(seat)["locked_seat"]):
        rows = np.searchsorted(candidate.floor.time, [0.1, 0.2, 0.3, 0.45, 0.55, 0.8])
        assert candidate.floor.command[rows] == pytest.approx([0.0, 0.0, 1.8, 1.8, 0.0, 1.8])


def test_each_intervention_changes_one_thing(seat):
    found, recorded = by_name(seat), seat.inputs["first"].floor
    zero = found["zero_current"].floor
    assert not zero.command.any() and not zero.coil_current.any()
    warm = found["warm_up"].floor
    assert warm.temperature[[0, -1]] == pytest.approx([20.0, 60.0])
    assert np.ptp(np.diff(warm.temperature)) < 1e-9
    assert np.array_equal(warm.command, recorded.command)
    assert {name: each.set for name, each in found.items() if each.set} == {"added_mass": {"plant.driver_mass": 100.0}}
    assert found["added_mass"].floor is recorded and found["coil_current"].floor is recorded
    assert found["load_cell"].floor is recorded


def test_factors_change_the_free_keys_of_an_excitation_and_no_current_exceeds_the_largest(seat):
    found = excite(seat, "sweep", {"amplitude": 2.0, "stop_frequency": 0.5, "current": 9.0})
    assert found.text == "sweep the floor from 1 to 10 Hz at 3 m/s^2"
    assert found.scenario["controller"] == {"law": "constant", "current": 2.0} and np.all(found.floor.command == 2.0)
    assert found.scenario["excitation"] == EXCITATIONS["sweep"].keys | {"stop_frequency": 10.0, "amplitude": 3.0}
    bump = excite(seat, "bump", {"height": 0.5})
    assert bump.text == "drive over a bump of 25 mm" and bump.scenario["excitation"]["height"] == 0.025
    for name, item in EXCITATIONS.items():
        assert set(item.free) <= {*item.keys, *item.law} - {"kind", "law"}, name


def test_a_bench_repeats_the_motion_of_its_damper(bench):
    found, inputs = by_name(bench)["coil_current"].floor, bench.inputs["first"]
    assert found.step == 1.0 / RATE and not found.acceleration.any() and not found.velocity.any()
    assert found.displacement is inputs.displacement
    assert found.command is inputs.current_command and found.temperature is inputs.damper_temperature
    assert found.coil_current is None


def test_a_bench_that_a_voltage_commands_repeats_it_as_a_current_and_can_be_run_without(bench):
    channels = {name: bench.recording.channels[name] for name in CHANNELS[:3]}
    channels["command_voltage"] = bench.recording.channels["current_command"]
    recording = dataclasses.replace(bench.recording, channels=channels)
    (inputs,) = bench.inputs.values()
    inputs = inputs._replace(current_command=None, command_voltage=np.full(400, 5.0), voltage_gain=0.1)
    found = by_name(dataclasses.replace(bench, recording=recording, inputs={"first": inputs}))
    assert found["coil_current"].floor.command == pytest.approx(0.5)
    assert not found["zero_current"].floor.command.any() and not found["zero_current"].set


@pytest.mark.parametrize("law", [None, LAWS.find("constant")(0.7)])
def test_a_current_that_is_not_recorded_is_switched_off_where_the_nominal_states_it(bench, law):
    channels = {name: bench.recording.channels[name] for name in CHANNELS[:3]}
    control = law and Control(law, None, None)
    scenario = dataclasses.replace(bench.scenario, control=control)
    recording = dataclasses.replace(bench.recording, channels=channels)
    found = by_name(dataclasses.replace(bench, recording=recording, scenario=scenario))
    assert [each.set for name, each in found.items() if name == "zero_current"] == (
        [{"controller.current": 0.0}] if law else []
    )
