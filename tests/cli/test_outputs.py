"""What the commands write of runs, and how they shorten names and numbers."""

import csv
import math
from types import SimpleNamespace

import pandas as pd
import pytest

from seatsim.cli.outputs.diagnosis_results import write_diagnosis
from seatsim.cli.outputs.writing import write_outputs
from seatsim.schema.errors import InputError
from seatsim.schema.yaml_source import Source


@pytest.mark.parametrize("rows", [list, pd.DataFrame])
def test_rows_become_cells_that_no_spreadsheet_computes(tmp_path, rows):
    content = rows([{"name": "=1+1", "n": 3, "x": math.nan}, {"name": "b", "n": 4, "x": 0.25}])
    [path] = write_outputs(tmp_path, {"t.csv": content})
    cells = list(csv.reader(path.read_text().splitlines()))
    assert cells == [["name", "n", "x"], ["'=1+1", "3", ""], ["b", "4", "0.25"]]


@pytest.mark.parametrize("wrong", ["augmented", "experiment"])
def test_a_scenario_that_cannot_be_loaded_again_is_not_written(tmp_path, kept_seat_file, wrong):
    good, bad = (dict(Source(kept_seat_file).data) for _ in range(2))
    bad["plant"] = {**bad["plant"], "driver_mass": -4.8}
    augmented, experiment = (bad if name == wrong else good for name in ("augmented", "experiment"))
    found = SimpleNamespace(augmented=augmented, experiment=SimpleNamespace(scenario=experiment))
    with pytest.raises(InputError, match=r"driver_mass: -4\.8 is not permitted"):
        write_diagnosis(found, tmp_path / "out")
    assert not (tmp_path / "out").exists()
