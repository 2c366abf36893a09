"""Scenario files: variants, sweeps, settings, examples, a user's own classes."""

import pytest

import seatsim
from seatsim.scenario.loading import load


def test_a_sweep_makes_every_combination_in_order(seat_file):
    seat_file.write_text(
        seat_file.read_text().replace("temperature: 20.0", "temperature: [20.0, 80.0]")
        + "variants: {light: {plant.driver_mass: 55.0}, heavy: {plant.driver_mass: 120.0}}\n"
    )
    runs = load(seat_file)
    stated = [(name, warm, mass) for name, mass in (("light", 55.0), ("heavy", 120.0)) for warm in (20.0, 80.0)]
    assert [(run.label["variant"], run.temperature, run.plant.driver_mass) for run in runs] == stated
    assert runs[1].title == "seat (light, temperature 80.0)"


def test_settings_replace_values_before_anything_is_read(seat_file):
    (run,) = load(seat_file, {"plant.driver_mass": 98.0, "controller": {"law": "constant", "current": 0.2}})
    assert run.plant.driver_mass == 98.0
    assert run.control.law.current == 0.2


def test_an_example_is_found_by_name(tmp_path, here):
    assert load("quickstart")[0].name == "quickstart"
    assert load("scenarios/quickstart.yaml")[0].name == "quickstart"
    with pytest.raises(seatsim.InputError, match=r"no such file.*quickstart, "):
        load("nothing")
    for elsewhere in (tmp_path / "quickstart.yaml", "elsewhere/quickstart.yaml"):
        with pytest.raises(seatsim.InputError, match="no such file"):
            load(elsewhere)
