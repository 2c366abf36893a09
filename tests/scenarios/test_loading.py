"""Scenario files: variants, sweeps, settings, examples, a user's own classes."""

import numpy as np
import pytest

import seatsim
from seatsim.scenario.loading import load

from ..text import parse


def test_a_sweep_makes_every_combination_in_order(seat_file):
    seat_file.write_text(
        seat_file.read_text().replace("temperature: 20.0", "temperature: [20.0, 80.0]")
        + "variants: {light: {plant.driver_mass: 55.0}, heavy: {plant.driver_mass: 120.0}}\n"
    )
    runs = load(seat_file)
    assert [(run.label["variant"], run.temperature, run.plant.driver_mass) for run in runs] == [
        ("light", 20.0, 55.0),
        ("light", 80.0, 55.0),
        ("heavy", 20.0, 120.0),
        ("heavy", 80.0, 120.0),
    ]
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


def test_whole_numbers_and_exponents_are_numbers(seat_file):
    (run,) = load(seat_file, {"plant.driver_mass": 80, "solver": {"step": 1e-3}})
    assert isinstance(run.plant.driver_mass, float)
    seat_file.write_text(seat_file.read_text() + "solver: {step: 1e-3}\n")
    assert load(seat_file)[0].solver.step == 1e-3


def test_a_users_own_damper_and_law_run_like_built_in_ones(seat_file, forget_own_code):
    file = seat_file.parent / "own_parts.py"
    file.write_text(
        "from typing import Annotated, NamedTuple\n"
        "from seatsim.rig.control import law\n"
        "from seatsim.dampers.base import damper\n"
        "from seatsim.schema.fields import param\n\n"
        "@damper('own', source='a test', current_order=1)\n"
        "class Own(NamedTuple):\n"
        "    c: Annotated[float, param('N s/(m A)', 'damping', low=0)] = 1000.0\n"
        "    def force(self, x, v, i, scaling, z):\n"
        "        return self.c * scaling.viscous * i * v\n\n"
        "@law('half')\n"
        "class Half(NamedTuple):\n"
        "    share: Annotated[float, param('-', 'share', low=0, high=1)] = 0.5\n"
        "    def wanted_current(self, y, state):\n"
        "        return self.share\n"
    )
    seatsim.use(file)
    own = seatsim.run(seat_file, {"damper": {"model": "own_parts:Own"}, "controller": {"law": "own_parts:Half"}})
    assert own["current_command"] == pytest.approx(np.full(6001, 0.5), abs=0)
    expected = 1000.0 * own["coil_current"] * own["suspension_velocity"]
    np.testing.assert_allclose(own["damper_force"], expected, atol=1e-9)
    assert np.max(np.abs(expected)) > 10.0


def test_a_result_gives_channels_with_units_and_a_table(seat_file):
    result = seatsim.run(seat_file)
    acceleration = result["driver_acceleration"]
    assert (acceleration.unit, acceleration.name, acceleration.shape) == ("m/s^2", "driver_acceleration", (6001,))
    assert result.table.driver_acceleration_rms[0] == pytest.approx(float(np.sqrt(np.mean(acceleration**2))))
    assert acceleration[100:].unit == "m/s^2" and (2 * acceleration).unit == ""


def test_the_public_names_exist():
    assert all(getattr(seatsim, name) is not None for name in seatsim.__all__)
    assert callable(seatsim.gap)


def test_a_run_that_diverges_is_a_failure_in_one_sentence(seat_file):
    settings = parse("""
        damper.parameters: {c_a: 0.0, c_b: 0.0, alpha_a: 0.0, alpha_b: 0.0, k0: -10000000.0, x0: 0.0, f0: 0.0,
            A: 1.0, beta: 0.0, gamma: 0.0, n: 1.0}
    """)
    with pytest.raises(seatsim.RunError, match="no solution beyond"):
        seatsim.run(seat_file, settings)


def test_merged_keys_and_aliases_are_read(seat_file):
    text = seat_file.read_text().replace("plant: {", "plant: &rig {")
    seat_file.write_text(text + "variants: {heavy: {plant: {<<: *rig, driver_mass: 120.0}}}\n")
    (run,) = load(seat_file)
    assert (run.plant.driver_mass, run.plant.frame_mass) == (120.0, 20.0)


def test_published_figures_stay_permitted_where_a_sweep_is_overridden(seat_file):
    seat_file.write_text(
        seat_file.read_text().replace("temperature: 20.0", "temperature: [20.0, 80.0]")
        + "published: {source: a paper, rows: [{temperature: 80.0, seat_factor: 0.5}]}\n"
    )
    assert len(load(seat_file)) == 2
    assert len(load(seat_file, {"temperature": 80.0})) == 1
    with pytest.raises(seatsim.InputError, match="did you mean 'seat_factor'"):
        load(seat_file, {"published": {"source": "a paper", "rows": [{"seat_facto": 0.5}]}})


def test_a_path_that_is_wrong_is_not_taken_for_an_example(tmp_path):
    with pytest.raises(seatsim.InputError, match="no such file"):
        load(tmp_path / "quickstart.yaml")
    with pytest.raises(seatsim.InputError, match="no such file"):
        load("elsewhere/quickstart.yaml")


@pytest.mark.parametrize("value", ["abc", None, True])
def test_a_published_figure_is_a_number(seat_file, value):
    with pytest.raises(seatsim.InputError, match="finite number"):
        load(seat_file, {"published": {"source": "a paper", "rows": [{"seat_factor": value}]}})


@pytest.mark.parametrize("changes", [{"controller.gain": ["2.0", 1.0]}, {"controller.sample_time": True}])
def test_numbers_are_numbers(seat_file, changes):
    with pytest.raises(seatsim.InputError, match="not permitted"):
        load(seat_file, changes)
