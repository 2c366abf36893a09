"""Which candidates the registered effects make on a recording, where their fits start, and between which bounds."""

import dataclasses

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import BoucWen
from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.objective import Parameters
from seatsim.effects.base import EFFECTS
from seatsim.effects.damper import GasSpring
from seatsim.effects.sensor import Gain
from seatsim.recordings.recording import ChannelEntry
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import DamperChoice
from seatsim.schema.fields import bounds
from seatsim.schema.registry import names

from ...text import words
from .toy import add_up, draw_signals, make_problem

COIL = {"coil.lag", "coil.asymmetric_lag", "coil.delay", "coil.current_limit"}
OF_THE_SEAT = set(
    words("""
    cushion.hardening cushion.separation driver.biodynamics driver.mass suspension.end_stop suspension.friction
    suspension.progressive_spring
""")
)


def posed(rig="seat", recorded=("current_command", "damper_force"), effects=(), damper=None, settings=None):
    """Return a problem on two accelerations with further channels that are recorded but not compared."""
    signals = draw_signals(["nominal"])
    problem = make_problem(signals, add_up(signals, {}), settings=settings)
    channels = problem.recording.channels | {name: ChannelEntry("-", 0.0) for name in recorded}
    header = problem.recording.header._replace(rig=rig)
    scenario = dataclasses.replace(problem.scenario, effects=effects)
    if damper is not None:
        scenario = dataclasses.replace(scenario, damper=DamperChoice(damper, TemperatureFactors()))
    recording = dataclasses.replace(problem.recording, header=header, channels=channels)
    return dataclasses.replace(problem, recording=recording, scenario=scenario)


def by_effect(found):
    return {name: [each for each in found if each.effect == name] for name in {each.effect for each in found}}


@pytest.fixture(scope="module")
def listed():
    return by_effect(list_candidates(posed()))


def test_every_effect_with_a_form_is_a_candidate_on_a_seat_with_a_command(listed):
    # An unmeasured input is random: no form of it is fitted.
    assert set(listed) == set(names("effect")) - {"floor.unmeasured_input"}


def test_an_effect_of_the_nominal_scenario_may_have_another_size_there(listed):
    changed = by_effect(list_candidates(posed(effects=(GasSpring(10.0, 70.0), Gain("driver_acceleration", 0.4)))))
    for absent, present in zip(listed["damper.gas_spring"], changed["damper.gas_spring"], strict=True):
        assert present.nominal == 10.0 and present.start[0] == absent.start[0] + 10.0
        # What a form does not change stays as it is in the scenario.
        assert present.record(present.start).stiffness == 70.0
    places = {each.fixed["channel"]: each.nominal for each in changed["sensor.gain"]}
    assert places == {"frame_acceleration": 0.0, "driver_acceleration": 0.4, "floor_acceleration": 0.0}


def test_without_a_command_nothing_can_be_said_of_the_coil():
    assert not COIL & set(by_effect(list_candidates(posed(recorded=("coil_current",)))))
    assert set(by_effect(list_candidates(posed(recorded=("command_voltage",))))) >= COIL


def test_a_current_that_never_falls_shows_no_memory_of_it():
    assert "damper.remanence" in by_effect(list_candidates(posed()))
    problem = dataclasses.replace(posed(), current_falls=False)
    assert "damper.remanence" not in by_effect(list_candidates(problem))


def test_a_bench_has_neither_seat_nor_driver():
    found = set(by_effect(list_candidates(posed("damper_bench"))))
    assert not found & OF_THE_SEAT
    assert found >= COIL | {"damper.gas_spring", "damper.free_play", "sensor.gain"}


def test_a_form_that_the_damper_has_already_is_no_candidate():
    assert "damper.preyield_hysteresis" in by_effect(list_candidates(posed()))
    assert "damper.preyield_hysteresis" not in by_effect(list_candidates(posed(damper=BoucWen())))


@pytest.mark.parametrize("name", sorted(set(names("effect")) - {"floor.unmeasured_input"}))
def test_an_effect_is_sought_as_its_record_has_it_by_default_and_with_each_further_parameter(listed, name):
    """A user who states an effect by what its record requires gets a form that a diagnosis knows, and so on."""
    cls, away = EFFECTS.find(name), EFFECTS.specification_of(EFFECTS.find(name)).off
    usual = cls._field_defaults
    if required := [field for field in cls._fields if field not in (*usual, "channel")]:

        def has_defaults(form):
            ranges = zip(form.free, form.low, form.high, strict=True)
            are_within = all(low <= usual.get(field, low) <= high for field, low, high in ranges)
            return are_within and all(form.fixed.get(field, value) == value for field, value in usual.items())

        assert any(set(required) <= set(each.free) and has_defaults(each) for each in listed[name])
    sought = {
        field
        for each in listed[name]
        for field in (*each.free, *(key for key, value in each.fixed.items() if value != away.get(key, 0.0)))
    }
    # A fluid that is warmer than its thermocouple by a constant is a damper of another size, as a tolerance has it.
    assert set(cls._fields) - sought == ({"rise"} if name == "damper.thermal_fade" else set())


def test_a_limit_starts_within_what_the_recording_reaches():
    found = by_effect(list_candidates(dataclasses.replace(posed(), reached={"m": 0.006, "A": 2.0})))
    assert [each.start[:2] for each in found["suspension.end_stop"][:2]] == [(-0.006, 0.006), (-0.003, 0.003)]
    # What lies within the reach is left where it is.
    assert found["coil.current_limit"][0].start == (0.8,)


def test_only_what_grows_towards_off_is_a_limit(listed):
    assert listed["cushion.separation"][0].is_limit
    assert listed["suspension.end_stop"][0].limits == [True, True, False, False, False]
    assert listed["coil.current_limit"][0].is_limit
    assert not listed["cushion.hardening"][0].is_limit
    # Its share is off at 1, but it is the travel that says how much it acts.
    shared = listed["damper.preyield_hysteresis"][1]
    assert shared.free == ("travel", "share") and shared.limits == [False, True] and not shared.is_limit
    starts = [each.start for each in listed["damper.preyield_hysteresis"] if each.structure == shared.structure]
    assert starts == [(3e-4, 0.3)]


def test_starts_off_values_and_what_a_fit_reaches_are_within_the_range_of_an_effect(listed):
    for candidate in (each for found in listed.values() for each in found):
        for name, start, low, high in zip(candidate.free, candidate.start, candidate.low, candidate.high, strict=True):
            permitted = bounds(candidate.cls, name)
            assert permitted[0] <= low < high <= permitted[1] and low <= start <= high, (candidate.effect, name)
        beyond = Parameters(np.zeros(0), (candidate,), (np.array(candidate.start),))
        for sign in (-1.0, 1.0):
            (values,) = beyond.move_to(np.full(len(candidate.free), sign * 1e12)).values
            assert np.all(values >= candidate.low) and np.all(values <= candidate.high)
    for cls in EFFECTS.classes():
        for name, value in EFFECTS.specification_of(cls).off.items():
            low, high = bounds(cls, name)
            assert low <= value <= high, (cls, name)


def test_frictions_have_the_same_forms_so_that_none_is_preferred_where_no_load_cell_tells_them(listed):
    seal, linkage = listed["damper.seal_friction"], listed["suspension.friction"]
    for name in ("free", "start", "low", "high"):
        assert [getattr(each, name) for each in seal] == [getattr(each, name) for each in linkage]


def test_buffers_beside_a_soft_spring_are_softer():
    problem = posed()
    plant = Plant(20.0, 60.0, 920.0, 100.0, 8e4, 300.0)
    soft = dataclasses.replace(problem, scenario=dataclasses.replace(problem.scenario, plant=plant))
    stop = by_effect(list_candidates(soft))["suspension.end_stop"][0]
    assert (stop.start[2], stop.low[2], stop.high[2]) == pytest.approx((2000.0, 1000.0, 2e5))
