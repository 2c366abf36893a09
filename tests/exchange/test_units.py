"""Exported units: equal to the functions that they are printed from, valid, and strict about what they are given."""

import dataclasses
import subprocess
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from seatsim.dampers.base import DAMPERS
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig_motion import RigOutputs, rig_block
from seatsim.exchange.export import write_fmu
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import DamperChoice
from seatsim.schema.errors import InputError
from seatsim.simulation.simulate import simulate

from ..text import words

STEP, SAMPLES = 1e-3, 300


def block_of(name, seat_file):
    cls = DAMPERS.find(name)
    choice = DamperChoice(cls(), DAMPERS.specification_of(cls).factors)
    return damper_block(dataclasses.replace(load(seat_file)[0], damper=choice))


@pytest.fixture(scope="module")
def units(kept_seat_file, tmp_path_factory):
    """The seat's damper as a unit of each version."""
    folder, block = tmp_path_factory.mktemp("units"), damper_block(load(kept_seat_file)[0])
    for version in (2, 3):
        write_fmu(block, version, folder / f"damper{version}.fmu")
    return folder


@pytest.fixture
def open_unit(units, tmp_path):
    """A unit of version 2 as FMPy opens it, instantiated."""
    description = fmpy.read_model_description(str(units / "damper2.fmu"))
    folder = fmpy.extract(str(units / "damper2.fmu"), str(tmp_path))
    told = []
    logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(lambda *values: told.append(values[2]))
    model = description.coSimulation.modelIdentifier
    named = {"guid": description.guid, "modelIdentifier": model, "instanceName": "damper"}
    unit = fmpy.fmi2.FMU2Slave(unzipDirectory=folder, **named)
    callbacks = fmpy.fmi2.fmi2CallbackFunctions()
    callbacks.logger = logger
    callbacks.allocateMemory = fmpy.fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
    callbacks.freeMemory = fmpy.fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
    unit.instantiate(callbacks=callbacks)
    unit.setupExperiment(startTime=0.0)
    unit.numbers = {v.name: v.valueReference for v in description.modelVariables}
    yield unit
    unit.freeInstance()


def motion():
    t = STEP * np.arange(SAMPLES)
    sine, cosine = np.sin(25.0 * t), np.cos(25.0 * t)
    moved = {"displacement": 0.01 * sine, "velocity": 0.25 * cosine, "acceleration": -6.25 * sine}
    return moved | {"command": 0.8 * (t > 0.1), "temperature": 20.0 + 100.0 * t}


def evaluate(block, inputs, step):
    """Return what the functions themselves give, evaluated by Python."""
    rows, state = [], None
    for k in range(len(next(iter(inputs.values())))):
        given = block.inputs._replace(**{name: float(values[k]) for name, values in inputs.items()})
        state = block.start(block.parameters, given, block.rest) if state is None else state
        state, good = block.advance(block.parameters, given, state, 0.0, step)
        assert good
        rows.append(block.observe(block.parameters, given, state, step))
    return np.array(rows)


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_in_a_host_in_c_equals_the_functions_bit_by_bit(version, host, seat_file, tmp_path, conform):
    name = {2: "modified_bouc_wen", 3: "hong_sigmoid_gaussian"}[version]
    block = block_of(name, seat_file)
    hosted = host.run_unit(block, version, motion(), tmp_path, STEP)
    deviation = np.max(np.abs(hosted[1:] - evaluate(block, motion(), STEP)))
    claim = f"{name} as a unit of FMI {version} in a host in C: greatest deviation of any output"
    conform(claim, "the functions it is printed from, in Python", deviation, tolerance=0.0)


def test_a_rig_in_a_host_in_c_equals_its_simulation(host, seat_file, tmp_path, conform):
    scenario = load(seat_file)[0]
    history = simulate(scenario, carry_all_effects=False)
    floor = scenario.excitation.floor(scenario.solver.step, scenario.seed)
    inputs = {"floor_acceleration": floor.acceleration[:-1], "floor_velocity": floor.velocity[:-1]}
    inputs |= {"floor_jerk": np.diff(floor.acceleration) / STEP}
    hosted = host.run_unit(rig_block(scenario), 2, inputs, tmp_path, STEP)
    for k, name in enumerate(RigOutputs._fields):
        expected = history[name][:-1] if name == "current_command" else history[name][1:]
        deviation = np.max(np.abs(hosted[1:, k] - expected)) / np.max(np.abs(expected))
        claim = f"rig as a unit of FMI 2 in a host in C: deviation of {name}, over its peak"
        conform(claim, "its simulation", deviation, tolerance=1e-11)


@pytest.mark.parametrize("version", [2, 3])
def test_fmpy_finds_nothing_and_simulates(version, units):
    path = str(units / f"damper{version}.fmu")
    assert validate_fmu(path) == []
    inputs = motion()
    names = ["time", *inputs]
    table = np.zeros(SAMPLES, dtype=[(name, float) for name in names])
    table["time"] = STEP * np.arange(SAMPLES)
    for name, values in inputs.items():
        table[name] = values
    steps = {"stop_time": 0.2, "output_interval": STEP, "step_size": STEP}
    result = fmpy.simulate_fmu(path, input=table, output=["force", "current"], **steps)
    assert result["current"][-1] == pytest.approx(0.8, rel=1e-5)
    assert np.max(np.abs(result["force"])) > 100.0


@pytest.fixture(scope="module")
def switching():
    """A rig whose law switches on what sensors read, and its simulation."""
    law = {"law": "hybrid", "damping": 1000.0, "share": 0.8, "sample_time": 0.005, "sensors": {"bandwidth": 80.0}}
    settings = {"seed": 1, "excitation.duration": 8.0, "variants": {}, "sweep": {}, "controller": law}
    (scenario,) = load("quickstart", settings)
    return scenario, simulate(scenario, carry_all_effects=False)


@pytest.mark.parametrize("version", [2, 3])
def test_a_rig_driven_by_the_floor_acceleration_alone_follows_its_simulation(version, switching, tmp_path, conform):
    # As masters do: the value at a communication point stands until the next. Held, it would be half a step late, by
    # which the law switches late, too: 8 % of the driver's acceleration and 38 % of the current.
    scenario, history = switching
    floor = np.zeros(len(history["time"]), dtype=[("time", float), ("floor_acceleration", float)])
    floor["time"], floor["floor_acceleration"] = history["time"], history["floor_acceleration"]
    write_fmu(rig_block(scenario), version, tmp_path / "rig.fmu")
    limits = {"driver_acceleration": 5e-4, "coil_current": 2e-3, "suspension_displacement": 3e-4}
    steps = {"stop_time": 8.0, "output_interval": STEP, "step_size": STEP}
    found = fmpy.simulate_fmu(str(tmp_path / "rig.fmu"), input=floor, output=[*limits], **steps)
    for name, limit in limits.items():
        error = found[name][: len(floor)] - history[name]
        deviation = np.sqrt(np.mean(error**2)) / np.std(history[name])
        claim = f"rig as a unit of FMI {version}: RMS deviation of {name} over its standard deviation"
        conform(claim, "FMPy, co-simulation master", deviation, tolerance=limit)


def test_the_rate_of_an_input_is_the_input_that_states_it(open_unit):
    unit, number = open_unit, open_unit.numbers
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.setReal([number["velocity"]], [0.1])
    start = unit.getFMUstate()
    forces = []
    for state in (
        lambda: unit.setReal([number["acceleration"]], [3.0]),
        lambda: unit.setRealInputDerivatives([number["velocity"], number["command"]], [1, 1], [3.0, 9.0]),
        lambda: unit.setRealInputDerivatives([number["velocity"]], [2], [3.0]),
    ):
        unit.setFMUstate(start)
        state()
        unit.doStep(0.0, 0.01)
        forces.append(unit.getReal([number["force"]]))
    assert forces[0] == forces[1] != forces[2]
    with pytest.raises(fmpy.fmi1.FMICallException):
        unit.setRealInputDerivatives([number["force"]], [1], [1.0])


def test_a_step_from_a_saved_state_gives_the_same_again(open_unit):
    unit, force = open_unit, [open_unit.numbers["force"]]
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.setReal([unit.numbers["velocity"], unit.numbers["command"]], [0.2, 0.7])
    unit.doStep(0.0, 0.01)
    state = unit.getFMUstate()
    kept = unit.serializeFMUstate(state)
    unit.doStep(0.01, 0.01)
    first = unit.getReal(force)
    unit.setReal([unit.numbers["velocity"]], [-0.1])
    unit.doStep(0.02, 0.05)
    assert unit.getReal(force) != first
    for again in (state, unit.deSerializeFMUstate(kept)):
        unit.setFMUstate(again)
        unit.doStep(0.01, 0.01)
        assert unit.getReal(force) == first
        unit.freeFMUstate(again)


def test_a_parameter_keeps_its_bounds_and_acts(open_unit):
    unit, number = open_unit, open_unit.numbers
    for reference, value in ((number["damper.n"], 25.0), (number["force"], 1.0), (999, 1.0)):
        with pytest.raises(fmpy.fmi1.FMICallException):
            unit.setReal([reference], [value])
    unit.setReal([number["damper.f0"]], [33.0])
    unit.enterInitializationMode()
    assert unit.getReal([number["force"]]) == [33.0]
    unit.exitInitializationMode()
    with pytest.raises(fmpy.fmi1.FMICallException):
        unit.doStep(0.0, -0.01)
    unit.reset()
    assert unit.getReal([number["damper.f0"]]) == [0.0]


OF_C = set(
    words("""
    exp expm1 log pow sqrt sin cos tan atan atan2 tanh sinh cosh hypot fabs floor ceil fmod copysign
    memcpy memset memmove malloc calloc free strcmp strcpy strlen snprintf __stack_chk_fail __snprintf_chk
    _ITM_deregisterTMCloneTable _ITM_registerTMCloneTable __cxa_finalize __gmon_start__
""")
)
"""What a library may take from outside: functions of C's own library."""


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_needs_nothing_but_the_library_of_c_and_is_small(version, units, tmp_path):
    path = units / f"damper{version}.fmu"
    assert path.stat().st_size < 80e3
    with zipfile.ZipFile(path) as archive:
        library = archive.extract(next(name for name in archive.namelist() if name.startswith("binaries/")), tmp_path)
    listed = subprocess.run(["nm", "-D", "-u", library], capture_output=True, text=True, check=True).stdout
    assert {line.split()[-1].partition("@")[0] for line in listed.splitlines()} <= OF_C


@pytest.mark.parametrize(
    ("named", "said"),
    [("", "no C compiler: install gcc"), ("nonexistent -O2", "CC names 'nonexistent', and there is no such program")],
)
def test_without_a_compiler_one_sentence_says_so(monkeypatch, seat_file, tmp_path, named, said):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("CC", named)
    with pytest.raises(InputError, match=said):
        write_fmu(damper_block(load(seat_file)[0]), 2, tmp_path / "unit.fmu")
    assert list(tmp_path.glob("*.fmu*")) == []
