"""Gains kept on disk: found once, searched anew where anything changed, never trusted where damaged."""

from dataclasses import replace

import numpy as np
import pytest

from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.solve import find_kept

GAIN = np.array([[-4056.484836105918, 1 / 3]])


@pytest.fixture
def plant(monkeypatch, tmp_path):
    monkeypatch.setenv("SEATSIM_CACHE_DIR", str(tmp_path / "cache"))
    one, two = np.eye(1), np.ones((1, 2))
    return GeneralisedPlant(-np.eye(2), two.T, two.T, two, np.eye(2), one, one, np.zeros((2, 1)))


def not_found():
    raise AssertionError("searched")


def test_a_gain_is_searched_once_and_kept_to_the_last_digit(plant):
    assert np.array_equal(find_kept([plant], lambda: GAIN), GAIN)
    assert np.array_equal(find_kept([plant], not_found), GAIN)


def test_another_plant_is_another_search(plant):
    find_kept([plant], lambda: GAIN)
    for other in ([replace(plant, A=-2 * np.eye(2))], [replace(plant, structure=[[1, 0]])], [plant, plant]):
        with pytest.raises(AssertionError, match="searched"):
            find_kept(other, not_found)


@pytest.mark.parametrize("text", ["", "[[1.0]]", "[[NaN, 1.0]]", "{}", '[["a", "b"]]', "[[1.0, 2.0"])
def test_a_damaged_file_is_searched_and_written_again(text, plant, tmp_path):
    find_kept([plant], lambda: GAIN)
    (file,) = tmp_path.rglob("*.json")
    file.write_text(text)
    assert np.array_equal(find_kept([plant], lambda: GAIN), GAIN)
    assert np.array_equal(find_kept([plant], not_found), GAIN)


def test_without_a_folder_nothing_is_kept(plant, tmp_path):
    (tmp_path / "cache").touch()
    find_kept([plant], lambda: GAIN)
    with pytest.raises(AssertionError, match="searched"):
        find_kept([plant], not_found)
