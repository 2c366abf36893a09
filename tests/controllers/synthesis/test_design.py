"""Designs on disk: exact, whole or absent, and readable without the solvers."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from ruamel.yaml import YAML

from controllers import Design
from seatsim.schema.errors import InputError


@pytest.fixture
def design(designed):
    return designed(30.0)


def test_round_trip_is_exact(design, tmp_path):
    design.save(tmp_path / "design.yaml")
    again = Design.load(tmp_path / "design.yaml")
    assert list(tmp_path.iterdir()) == [tmp_path / "design.yaml"]
    for name in ("gain", "poles"):
        np.testing.assert_array_equal(getattr(again, name), getattr(design, name))
    for name in ("gamma", "max_gain", "lower_bound", "peak_frequency"):
        assert getattr(again, name) == getattr(design, name)
    plain = YAML(typ="safe").load(tmp_path / "design.yaml")
    assert {"gain", "gamma", "lower_bound", "certificate"} <= set(plain)
    np.testing.assert_allclose(plain["certificate"]["matrix"], design.certificate.matrix)
    for name in ("norms_agree", "disk_margin"):
        assert getattr(again.worst, name) == getattr(design.worst, name)
    np.testing.assert_array_equal(again.worst.plant.A, design.worst.plant.A)
    np.testing.assert_array_equal(again.certificate.factor, design.certificate.factor)
    assert again.certificate.gamma == design.certificate.gamma
    assert again.certificate.largest_eigenvalue == design.certificate.largest_eigenvalue


def test_the_worst_of_several_loops_speaks_for_the_design(design, tmp_path):
    low, high = (replace(design.worst, gamma=gamma, peak_frequency=gamma) for gamma in (1.0, 3.0))
    for loops in ((low, high), (high, low)):
        both = Design(design.gain, 1e6, 0.5, loops)
        assert both.worst is high
        assert (both.gamma, both.peak_frequency) == (3.0, 3.0)
        both.save(tmp_path / "both.yaml")
        assert [loop.gamma for loop in Design.load(tmp_path / "both.yaml").loops] == [loop.gamma for loop in loops]


def test_nothing_is_left_where_writing_fails(design, tmp_path):
    (tmp_path / "design.yaml").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        design.save(tmp_path / "design.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["design.yaml"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("gain: [[1.0]]", "lacks the key 'loops'"),
        ("[1, 2]", "holds no mapping"),
        ("a: [", "line 2: did not find"),
        ("", "holds no mapping"),
        ("{gain: [[.nan]], max_gain: 1, lower_bound: 0, loops: []}", "not a finite number"),
        ("{gain: [1.0], max_gain: 1, lower_bound: 0, loops: []}", "loops is empty"),
    ],
)
def test_broken_files_are_named(tmp_path, text, words):
    path = tmp_path / "design.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        Design.load(path)
    assert str(path) in str(caught.value)


def test_loading_needs_no_solver(design, tmp_path):
    design.save(tmp_path / "design.yaml")
    code = """
import sys
from controllers import Design, synthesise
Design.load(sys.argv[1])
assert "cvxpy" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "design.yaml")], check=True)
