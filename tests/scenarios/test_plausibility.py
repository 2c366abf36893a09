"""Values that are permitted but that no seat has are said, with what was probably meant."""

import pytest

import seatsim
from seatsim.scenario.loading import load
from seatsim.scenario.numbers import list_doubts

ROAD = {"kind": "road", "road_class": "B", "speed": 80.0, "duration": 5.0}


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("plant.suspension_stiffness", 4.6, "4.6 N/m is unusual, since seats have 200 to 1e+06 N/m; 4.6 N/mm would"),
        ("plant.suspension_damping", 0.15, "0.15 N s/mm would be 150 N s/m"),
        ("plant.cushion_stiffness", 60.0, "60 N/mm would be 6e+04 N/m"),
        ("plant.driver_mass", 8.0, "8 kg is unusual, since seats have 20 to 250 kg"),
        ("plant.travel", [-5.0, 5.0], "-5 m is unusual, since seats have 0.01 to 0.12 m; -5 cm would be -0.05 m"),
        ("start.displacement", 9.0, "9 mm would be 0.009 m"),
        ("temperature", 180.0, "temperature: 180 degC is unusual"),
    ],
)
def test_an_unusual_value_is_said_with_what_was_meant(key, value, said, seat_file):
    (scenario,) = load(seat_file, {key: value})
    (doubt,) = list_doubts(scenario)
    assert said in doubt and f"--set {key}=" in doubt


@pytest.mark.parametrize(
    ("key", "value", "meant"),
    [
        ("plant.travel", [-185.0, 185.0], "at least -10 m"),
        ("plant.travel", [-50.0, 50.0], "at least -10 m; -50 mm would be -0.05 m"),
        ("temperature", 293.0, "at most 200 degC; 293 K would be 19.85 degC"),
        ("excitation", ROAD, "80 km/h would be 22.22 m/s"),
        ("actuator.delay", 4.0, "4 ms would be 0.004 s"),
    ],
)
def test_a_value_out_of_bounds_says_what_was_meant(key, value, meant, seat_file):
    with pytest.raises(seatsim.InputError) as error:
        load(seat_file, {key: value})
    assert meant in str(error.value)


SAME = "nothing depends on the temperature"


@pytest.mark.parametrize(
    ("settings", "depends"),
    [
        ({}, False),
        ({"damper.temperature_factors": {"viscous": -0.005}}, True),
        ({"effects": [{"effect": "damper.thermal_fade", "parameters": {"viscous": 0.004}}]}, True),
        ({"effects": [{"effect": "suspension.friction", "parameters": {"force": 40.0}}]}, False),
    ],
)
def test_a_temperature_that_changes_nothing(settings, depends, seat_file):
    scenarios = load(seat_file, {"temperature": [20.0, 60.0], **settings})
    assert [any(SAME in doubt for doubt in list_doubts(each)) for each in scenarios] == [not depends] * 2
    assert not list_doubts(load(seat_file, {"temperature": 60.0, **settings})[0])


def test_a_travel_that_no_seat_has_is_said_where_none_is_stated(seat_file):
    far = {
        "excitation": {"kind": "sine", "amplitude": 0.15, "frequency": 1.3, "duration": 4.0},
        "controller": {"law": "constant", "current": 0.0},
    }
    (run,) = seatsim.run(seat_file, far).runs
    assert any("mm from its mid-stroke" in warning and "state plant.travel" in warning for warning in run.warnings)
    (run,) = seatsim.run(seat_file, {**far, "plant.travel": [-0.05, 0.05]}).runs
    assert not any("mid-stroke" in warning for warning in run.warnings)


def test_a_gap_says_what_is_doubtful_about_its_scenario(sound):
    odd = seatsim.load(sound / "nominal.yaml", {"plant.suspension_damping": 30000.0})[0]
    notes = seatsim.gap(odd, sound).notes
    assert any("30000 N s/m is unusual" in note for note in notes)
