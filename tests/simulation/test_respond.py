"""One way from a scenario and inputs to what sensors say, on a seat and on a bench."""

from dataclasses import replace

import numpy as np
import pytest

from seatsim.effects.base import off
from seatsim.excitations.base import Floor
from seatsim.scenario.loading import load, single
from seatsim.scenario.scenario import Start
from seatsim.schema.registry import find
from seatsim.simulation.inputs import BenchInputs, Forces, SeatInputs
from seatsim.simulation.respond import SEAT_OUTPUTS, respond

from ..text import beside

SEAT = beside(__file__, "replayed_seat.yaml")
STEP = 0.001


@pytest.fixture(scope="module")
def seat(tmp_path_factory):
    """A seat whose damper is linear: 500 N s/m beside the 150 N s/m of the suspension."""
    path = tmp_path_factory.mktemp("respond") / "seat.yaml"
    path.write_text(SEAT)
    return load(path)[0]


@pytest.fixture(scope="module")
def inputs():
    time = STEP * np.arange(2001)
    shaken, still = np.sin(2 * np.pi * 2.0 * time) * np.minimum(time, 1.0), np.zeros(len(time))
    command = 0.5 * (time > 0.5)
    return SeatInputs(Floor(STEP, shaken, still, still, command), 5 * STEP)


@pytest.mark.parametrize(("place", "mass"), [("frame", 20.0), ("driver", 80.0)])
def test_a_force_pushes_the_mass_that_it_acts_on(seat, inputs, place, mass):
    forces = Forces(**{place: 20.0 * np.cos(7.0 * STEP * np.arange(2001))})
    answer = respond(seat, inputs._replace(forces=forces))
    assert tuple(answer) == SEAT_OUTPUTS and answer[f"{place}_acceleration"][0] == pytest.approx(20.0 / mass)


def test_where_no_command_is_recorded_the_coil_current_drives(seat, inputs):
    flowing = 0.3 + 0.1 * np.sin(inputs.floor.time)
    floor = inputs.floor._replace(command=None, coil_current=flowing)
    assert respond(seat, inputs._replace(floor=floor))["coil_current"] == pytest.approx(flowing[::5], abs=1e-12)


def test_the_rig_starts_at_rest_wherever_the_scenario_puts_it(seat, inputs):
    moved = replace(seat, start=Start(0.02, 0.1))
    assert np.array_equal(respond(moved, inputs)["damper_force"], respond(seat, inputs)["damper_force"])


def test_what_sensors_say_is_what_effects_make_of_it(seat, inputs):
    true = respond(seat, inputs)
    gain = find("effect", "sensor.gain")("driver_acceleration", 0.25)
    answer = respond(replace(seat, effects=(gain,)), inputs)
    assert answer["driver_acceleration"] == pytest.approx(1.25 * true["driver_acceleration"], rel=1e-12)
    assert np.array_equal(answer["frame_acceleration"], true["frame_acceleration"])
    floor = find("effect", "sensor.gain")("floor_acceleration", 1.0)
    halved = respond(replace(seat, effects=(floor,)), inputs)
    assert halved["driver_acceleration"] == pytest.approx(0.5 * true["driver_acceleration"], abs=1e-6)


@pytest.fixture
def bench(seat):
    return replace(seat, plant=None, control=None)


ROWS = 0.002 * np.arange(1500)
MOVED = BenchInputs(0.002, 0.01 * np.sin(8.0 * ROWS))


def test_a_bench_answers_with_the_damper_at_the_speed_of_its_displacement(bench):
    answer = respond(bench, MOVED)
    assert tuple(answer) == ("damper_force", "coil_current")
    assert answer["damper_force"][5:-5] == pytest.approx(500.0 * 0.08 * np.cos(8.0 * ROWS)[5:-5], abs=1e-3)
    assert np.all(answer["coil_current"] == 0.0)


def test_a_command_is_held_and_followed_from_the_recorded_current_on(bench):
    command = np.where(ROWS < 1.0, 0.2, 0.8)
    start = np.full(1500, 0.6)
    current = respond(bench, MOVED._replace(current_command=command, coil_current=start))["coil_current"]
    first = 0.2 + 0.4 * np.exp(-130.0 * ROWS)
    after = 0.8 - 0.6 * np.exp(-130.0 * np.maximum(ROWS - 1.0, 0.0))
    assert current == pytest.approx(np.where(ROWS < 1.0, first, after), abs=1e-9)


def test_a_command_voltage_counts_with_its_gain_and_a_command_before_it(bench):
    volts = np.full(1500, 2.0)
    by_voltage = respond(bench, MOVED._replace(command_voltage=volts, voltage_gain=0.3))["coil_current"]
    assert by_voltage[-1] == pytest.approx(0.6, rel=1e-9)
    both = MOVED._replace(command_voltage=volts, voltage_gain=0.3, current_command=np.full(1500, 0.1))
    assert respond(bench, both)["coil_current"][-1] == pytest.approx(0.1, rel=1e-9)
    too_much = respond(bench, MOVED._replace(current_command=np.full(1500, 3.0)))["coil_current"]
    assert too_much[-1] == pytest.approx(1.0, rel=1e-9)


def test_a_recorded_temperature_scales_the_damper(bench):
    factors = bench.damper.factors._replace(viscous=-0.01)
    warm = replace(bench, damper=replace(bench.damper, factors=factors))
    by_row = respond(warm, MOVED._replace(damper_temperature=np.full(1500, 40.0)))["damper_force"]
    assert by_row[5:-5] == pytest.approx(np.exp(-0.2) * respond(bench, MOVED)["damper_force"][5:-5], abs=1e-2)


BENCH = """\
damper: {model: bingham, parameters: {c_a: 500.0, c_b: 300.0, fc_a: 0.0, fc_b: 0.0, f0: 0.0, v_ref: 0.004}}
actuator: {rate: 130.0, max_current: 1.0}
temperature: 20.0
"""
ROW = 0.004


@pytest.fixture(scope="module")
def press(tmp_path_factory):
    path = tmp_path_factory.mktemp("respond") / "bench.yaml"
    path.write_text(BENCH)
    return single(path)


@pytest.fixture(params=["current_command", "command_voltage"])
def driven(request):
    """A bench whose command is stepped, in A or by a voltage of 2 V/A."""
    time = ROW * np.arange(500)
    wanted = np.random.default_rng(4).uniform(0.1, 0.9, 20)[np.arange(500) // 25]
    inputs = BenchInputs(ROW, 0.01 * np.sin(9.0 * time), voltage_gain=0.5)
    return inputs._replace(**{request.param: wanted if request.param == "current_command" else 2.0 * wanted})


def force(scenario, inputs, *effects):
    return respond(replace(scenario, effects=effects), inputs)["damper_force"]


@pytest.mark.parametrize("late", [0.0093, 0.02])
def test_a_late_command_and_a_log_that_runs_ahead_delay_the_force_of_a_bench_by_just_that(press, driven, late):
    """The truth is sampled finely enough to hold the delay in whole rows."""
    fine = 40
    parts = {name: getattr(driven, name) for name in ("current_command", "command_voltage")}
    held = {name: np.repeat(values, fine) for name, values in parts.items() if values is not None}
    delayed = {name: np.append(np.zeros(round(late / ROW * fine)), values) for name, values in held.items()}
    moving = 0.01 * np.sin(9.0 * ROW / fine * np.arange(len(next(iter(delayed.values())))))
    expected = force(press, driven._replace(interval=ROW / fine, displacement=moving, **delayed))[::fine][:500]
    inner = slice(20, -10)
    exact = force(press, driven, off(find("effect", "coil.delay"))._replace(time=late))
    assert exact[inner] == pytest.approx(expected[inner], abs=1e-3)
    for hold in (0.0, ROW / 16):
        ahead = force(press, driven, off(find("effect", "sensor.clock_skew"))._replace(shift=-late, hold=hold))
        assert np.sqrt(np.mean((ahead - expected)[inner] ** 2)) < 5e-3 * np.std(expected)


@pytest.mark.parametrize(
    ("name", "field", "at"), [("coil.delay", "time", 0.0133), ("sensor.clock_skew", "shift", -0.0101)]
)
def test_a_seat_feels_the_smallest_change_of_a_delay(seat, inputs, name, field, at):
    cls = find("effect", name)
    felt = replace(seat, damper=replace(seat.damper, record=seat.damper.record._replace(c_b=300.0)))
    base, near = (force(felt, inputs, off(cls)._replace(**{field: at + h})) for h in (0.0, 1e-6))
    assert np.max(np.abs(near - base)) > 1e-4
