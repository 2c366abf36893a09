"""What the commands write of runs, and how they shorten names and numbers."""

import inspect
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from ruamel.yaml import YAML

from seatsim.cli.commands.recordings import diagnose as diagnose_command
from seatsim.cli.outputs import characterisation as output
from seatsim.cli.outputs import diagnosis
from seatsim.cli.outputs import runs as outputs
from seatsim.diagnosis.diagnose import BUDGET
from seatsim.metrics.table import Metric
from seatsim.schema.errors import InputError
from seatsim.schema.files import plain


class Bounds:
    """A bound that falls by 20 m/s^2 a metre, and a best run 0.1 m/s^2 above it."""

    def bound(self, travel):
        return 1.0 - 20.0 * travel

    def best(self, travel):
        return self.bound(travel) + 0.1

    def as_dict(self):
        return {"travel_m": [0.01]}


def run(name, rig, acceleration=0.88, travel=0.01):
    metrics = {
        "driver_acceleration_weighted": Metric(acceleration, "m/s^2", "weighted"),
        "suspension_displacement_rms": Metric(travel, "m", "travel"),
    }
    scenario = SimpleNamespace(name=name, rig=rig, label={"variant": "soft"})
    history = SimpleNamespace(notes=["n"])
    return SimpleNamespace(scenario=scenario, metrics=metrics, warnings=("hot",), unverified=(), history=history)


def test_each_rig_has_its_bounds_and_the_distances_of_its_runs():
    result = SimpleNamespace(runs=[run("a", "one"), run("b", "two"), run("c", "one", 1.2)], brackets={"one": Bounds()})
    [found] = outputs._encode_brackets(result)
    assert found["travel_m"] == [0.01]
    assert [each["scenario"] for each in found["runs"]] == ["a", "c"]
    first = found["runs"][0]
    assert list(first) == [
        "scenario", "label", "acceleration", "travel", "bound", "best", "above_bound", "above_best",
    ]  # fmt: skip
    assert (first["bound"], first["best"]) == pytest.approx((0.8, 0.9))
    assert (first["above_bound"], first["above_best"]) == pytest.approx((0.1, 0.88 / 0.9 - 1))


def test_a_summary_states_metrics_with_unit_and_meaning():
    found = json.loads(json.dumps(plain(outputs._encode_summary(run("a", "one")))))
    assert list(found) == ["scenario", "label", "metrics", "warnings", "unverified", "notes"]
    assert found["metrics"]["suspension_displacement_rms"] == {"value": 0.01, "unit": "m", "meaning": "travel"}
    assert found["warnings"] == ["hot"] and found["notes"] == ["n"]


def test_equal_figures_give_equal_files(tmp_path):
    def figure():
        drawn = Figure(figsize=(2, 1))
        drawn.add_subplot().plot(np.arange(3))
        return drawn

    paths = outputs.write_pictures({"a": figure(), "b": figure()}, tmp_path)
    assert [path.name for path in paths] == ["a.png", "b.png"]
    first, second = (path.read_bytes() for path in paths)
    assert first == second and b"matplotlib" not in first


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [(1.25, ".1f", "1.2"), (-0.04, ".1f", "0.0"), (-0.06, ".1f", "-0.1"), (math.nan, ".0f", "-"), (math.inf, "g", "-")],
)
def test_numbers_of_a_table(value, form, text):
    assert output._format_number(value, form) == text


def test_names_of_a_table_are_short():
    assert output._shorten("sixteen letters!") == "sixteen letters!"
    assert output._shorten("a name of a long record") == "a name …g record"
    assert output._list_names(["a", "b", "c"]) == "a, b, c"
    assert output._list_names(list("abcd")) == "a and 3 more"


@pytest.mark.parametrize("wrong", ["augmented", "experiment"])
def test_a_scenario_that_cannot_be_loaded_again_is_not_written(tmp_path, kept_seat_file, wrong):
    good, bad = (YAML(typ="safe").load(kept_seat_file.read_text()) for _ in range(2))
    bad["plant"]["driver_mass"] = -4.8
    contents = {"augmented": good, "experiment": good} | {wrong: bad}
    found = SimpleNamespace(
        augmented=contents["augmented"], experiment=SimpleNamespace(scenario=contents["experiment"])
    )
    with pytest.raises(InputError, match=r"driver_mass: -4\.8 is not permitted"):
        diagnosis.write_diagnosis(found, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_commands_budget_is_that_of_the_function():
    assert inspect.signature(diagnose_command).parameters["budget"].default == BUDGET
