"""Designs on disk: exact, whole or absent."""

from dataclasses import replace

import numpy as np
import pytest
from ruamel.yaml import YAML

from controllers import Design
from controllers.laws.static_output_feedback import StaticOutputFeedback
from seatsim.rig.coil import Coil
from seatsim.rig.control import prepare_law
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError

SEAT = Plant(20.0, 80.0, 4600.0, 150.0, 6e4, 1500.0)


def read(path):
    return YAML(typ="safe").load(path)


@pytest.fixture
def design(designed):
    return designed(30.0)


def test_a_file_holds_a_design_exactly(design, tmp_path):
    design.save(tmp_path / "design.yaml")
    assert list(tmp_path.iterdir()) == [tmp_path / "design.yaml"]
    plain = read(tmp_path / "design.yaml")
    (loop,) = plain["loops"]
    np.testing.assert_array_equal(plain["gain"], design.gain)
    for name in ("gamma", "max_gain", "lower_bound"):
        assert plain[name] == getattr(design, name)
    np.testing.assert_allclose(plain["certificate"]["matrix"], design.certificate.matrix)
    for name in ("gamma", "peak_frequency", "norms_agree", "disk_margin"):
        assert loop[name] == getattr(design.worst, name)
    np.testing.assert_array_equal(loop["plant"]["A"], design.worst.plant.A)
    np.testing.assert_array_equal(loop["certificate"]["factor"], design.certificate.factor)


def test_the_worst_of_several_loops_speaks_for_the_design(design, tmp_path):
    low, high = (replace(design.worst, gamma=gamma, peak_frequency=gamma) for gamma in (1.0, 3.0))
    for loops in ((low, high), (high, low)):
        both = Design(design.gain, 1e6, 0.5, loops)
        assert both.worst is high
        assert (both.gamma, both.worst.peak_frequency) == (3.0, 3.0)
        both.save(tmp_path / "both.yaml")
        assert [loop["gamma"] for loop in read(tmp_path / "both.yaml")["loops"]] == [loop.gamma for loop in loops]


def test_nothing_is_left_where_writing_fails(design, tmp_path):
    (tmp_path / "design.yaml").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        design.save(tmp_path / "design.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["design.yaml"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("gamma: 1.0", "gain: this key is missing"),
        ("[1, 2]", "holds no mapping"),
        ("a: [", "line 2: did not find"),
        ("", "holds no mapping"),
        ("gain: [[.nan, 1.0]]", "finite number"),
        ("gain: [1.0]", "must be a list"),
        ("gain: [[1.0, 2.0, 3.0]]", r"shape \(1, 3\)"),
    ],
)
def test_broken_files_are_named(tmp_path, text, words):
    path = tmp_path / "design.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        prepare_law(StaticOutputFeedback(design=str(path)), SEAT, Coil(), 0.005)
    assert str(path) in str(caught.value)
