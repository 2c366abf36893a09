"""Roads: OpenCRG as text and binary, and tables over distance, become an excitation that runs."""

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

from seatsim.excitations.table import Table
from seatsim.importing.importing import import_files
from seatsim.importing.readers.reading import read_file
from seatsim.schema.errors import InputError

from . import exports
from .helpers import write_csv


@pytest.fixture
def elevations():
    rows = np.arange(4001) * 0.01
    return np.column_stack([0.01 * np.sin(rows * k) + 0.001 * k for k in (1.0, 2.0, 3.5)])


@pytest.mark.parametrize("kind", ["KRBI", "LRFI"])
def test_an_opencrg_road_becomes_an_excitation(tmp_path, elevations, kind):
    exports.opencrg(tmp_path / "road.crg", elevations, kind=kind)
    import_files([tmp_path / "road.crg"], tmp_path / "out")
    table = pd.read_csv(tmp_path / "out" / "road.csv.gz")
    assert list(table) == ["distance_m", "z at -0.50 m", "z at +0.00 m", "z at +0.50 m"]
    np.testing.assert_allclose(table["distance_m"], np.arange(4001) * 0.01, atol=1e-9)
    np.testing.assert_allclose(table.iloc[:, 1:], elevations, atol=2e-6)
    stated = YAML(typ="safe").load(tmp_path / "out" / "excitation.yaml")["excitation"]
    assert stated.pop("kind") == "table"
    floor = Table(**{**stated, "path": str(tmp_path / "out" / stated["path"])}).floor(0.001, 0)
    assert np.std(floor.acceleration) > 0.0


def test_a_track_that_was_not_measured_throughout_is_left_out(tmp_path, elevations):
    elevations[100:200, 0] = np.nan
    exports.opencrg(tmp_path / "road.crg", elevations, kind="LRFI")
    found = import_files([tmp_path / "road.crg"], tmp_path / "out")
    assert any("left out: z at -0.50 m" in issue.sentence for issue in found.doubts)
    assert list(pd.read_csv(tmp_path / "out" / "road.csv.gz"))[1:] == ["z at +0.00 m", "z at +0.50 m"]


@pytest.mark.parametrize("kind", ["KRBI", "LRFI"])
def test_a_truncated_road_is_one_clear_error(tmp_path, elevations, kind):
    path = tmp_path / "road.crg"
    exports.opencrg(path, elevations, kind=kind)
    path.write_bytes(path.read_bytes()[: -len(path.read_bytes()) // 5])
    with pytest.raises(InputError, match="of 4001 cross sections; the file is truncated"):
        read_file(path)


def test_a_table_over_distance_is_a_road(tmp_path):
    distance = np.arange(0.0, 300.0, 0.25)
    path = write_csv(tmp_path / "a.csv", {"distance_m": distance, "elevation_m": 583.0 + 0.02 * np.sin(distance)})
    found = import_files([path], tmp_path / "out")
    assert found.map.rig == "road"
    said = " ".join(issue.sentence for issue in found.doubts)
    assert "waves shorter than 0.5 m are missing" in said
    assert "absolute elevation" in said
