"""What the commands write of runs, and how they shorten names and numbers."""

import csv
import inspect
import math
from types import SimpleNamespace

import pandas as pd
import pytest

from seatsim.cli.commands.recordings import diagnose as diagnose_command
from seatsim.cli.outputs.diagnosis_results import write_diagnosis
from seatsim.cli.outputs.writing import write_outputs
from seatsim.cli.show_table import format_number
from seatsim.diagnosis.diagnose import BUDGET
from seatsim.schema.errors import InputError
from seatsim.schema.printing import shorten
from seatsim.schema.yaml_source import Source


@pytest.mark.parametrize("rows", [list, pd.DataFrame])
def test_rows_become_cells_that_no_spreadsheet_computes(tmp_path, rows):
    content = rows([{"name": "=1+1", "n": 3, "x": math.nan}, {"name": "b", "n": 4, "x": 0.25}])
    [path] = write_outputs(tmp_path, {"t.csv": content})
    cells = list(csv.reader(path.read_text().splitlines()))
    assert cells == [["name", "n", "x"], ["'=1+1", "3", ""], ["b", "4", "0.25"]]


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [(1.25, ".1f", "1.2"), (-0.04, ".1f", "0.0"), (-0.06, ".1f", "-0.1"), (math.nan, ".0f", "-"), (math.inf, "g", "-")],
)
def test_numbers_of_a_table(value, form, text):
    assert format_number(value, form) == text


def test_names_of_a_table_are_short():
    assert shorten("sixteen letters!", 16) == "sixteen letters!"
    assert shorten("a name of a long record", 16) == "a name …g record"


@pytest.mark.parametrize("wrong", ["augmented", "experiment"])
def test_a_scenario_that_cannot_be_loaded_again_is_not_written(tmp_path, kept_seat_file, wrong):
    good, bad = (dict(Source(kept_seat_file).data) for _ in range(2))
    bad["plant"] = {**bad["plant"], "driver_mass": -4.8}
    augmented, experiment = (bad if name == wrong else good for name in ("augmented", "experiment"))
    found = SimpleNamespace(augmented=augmented, experiment=SimpleNamespace(scenario=experiment))
    with pytest.raises(InputError, match=r"driver_mass: -4\.8 is not permitted"):
        write_diagnosis(found, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_commands_budget_is_that_of_the_function():
    assert inspect.signature(diagnose_command).parameters["budget"].default == BUDGET
