"""The three name spaces for users: what they list, and what is shown of their values."""

import subprocess
import sys

import numpy as np
import pytest

import controllers
import seatsim
import seatsim.dampers
import seatsim.effects
import seatsim.laws


@pytest.mark.parametrize("space", [seatsim, controllers, seatsim.dampers, seatsim.effects, seatsim.laws])
def test_every_public_name_is_there_and_described(space):
    assert set(space.__all__) <= set(dir(space))
    for name in space.__all__:
        assert getattr(space, name).__doc__, name


def test_asking_for_the_names_imports_nothing_heavy():
    code = "import sys, seatsim; dir(seatsim); print({'numpy', 'pandas', 'numba', 'typing'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_what_is_returned_fits_a_screen_and_goes_to_pandas(seat_file):
    seat_file.write_text(seat_file.read_text() + f"sweep: {{plant.driver_mass: {[60.0 + k for k in range(12)]}}}\n")
    result = seatsim.run(seat_file, {"excitation.duration": 0.5})
    run = result.runs[0]
    for shown in map(repr, (result, run, run.history, run.scenario)):
        assert len(shown.splitlines()) <= 24 and len(shown) < 3000
        assert run.scenario.name in shown or "driver_acceleration" in shown
    assert "and 2 more" in repr(result)
    frame = run.history.to_pandas()
    assert list(frame) == list(run.history.channels) and len(frame) == 501
    np.testing.assert_array_equal(frame.driver_acceleration, run["driver_acceleration"])


def test_a_scenario_made_of_a_mapping_is_that_of_the_file(seat_file):
    from seatsim.schema.yaml_source import Source

    stated = Source(seat_file).data
    numbers = {key: np.float64(value) for key, value in stated["plant"].items() if isinstance(value, float)}
    mapping = {**stated, "plant": {**stated["plant"], **numbers}, "seed": np.int64(7)}
    (run,) = seatsim.run(mapping, {"excitation.duration": 0.5, "name": "seat"}).runs
    (same,) = seatsim.run(seat_file, {"excitation.duration": 0.5, "seed": 7}).runs
    found, expected = ({name: each.value for name, each in some.metrics.items()} for some in (run, same))
    assert found == expected
    with pytest.raises(seatsim.InputError, match=r"^scenario, plant\.driver_mass: -1"):
        seatsim.load({**mapping, "plant": {**mapping["plant"], "driver_mass": -1}})
