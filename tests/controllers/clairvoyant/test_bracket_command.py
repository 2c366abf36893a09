"""`compare --bracket`: the table of distances, the files, and what has no bracket."""

import dataclasses
import json

import numpy as np
import pytest

from controllers.clairvoyant import ClairvoyantBounds
from seatsim.schema.errors import InputError

LAWS = """
variants:
  soft: {controller: {law: constant, current: 0.0}}
  hard: {controller: {law: constant, current: 1.0}}
"""


class Made:
    """A kind of bracket that takes no time."""

    @staticmethod
    def of(scenario, progress):
        progress("at work")
        weights, travel = np.array([400.0, 3600.0]), np.array([0.012, 0.001])
        return ClairvoyantBounds(weights, np.array([0.08, 0.15]), np.array([0.2, 0.4]), travel, np.zeros((2, 0)), 0.005)


class Beaten:
    """A kind whose bound is too high."""

    @staticmethod
    def of(scenario, progress):
        return dataclasses.replace(Made.of(scenario, progress), lower=np.array([9.0, 0.15]))


class Refused:
    """A kind that has none."""

    @staticmethod
    def of(scenario, progress):
        raise InputError("the seat is bent")


class Interrupted:
    """A kind that is interrupted at work."""

    @staticmethod
    def of(scenario, progress):
        raise KeyboardInterrupt


@pytest.fixture
def compared(seat_file, tmp_path, monkeypatch, seatsim_command):
    def call(kind):
        seat_file.write_text(seat_file.read_text() + LAWS)
        monkeypatch.setattr("seatsim.simulation.performance_bounds.find", lambda *_: kind)
        status, out, err = seatsim_command("compare", seat_file, "--bracket", "--out", tmp_path / "o")
        assert status == 0
        return out, err, tmp_path / "o"

    return call


def test_distances_are_printed_and_written(compared):
    said, _, folder = compared(Made)
    assert "above" in said and "brackets.json" in said
    [rig] = json.loads((folder / "brackets.json").read_text())["rigs"]
    assert rig["width"] == pytest.approx(
        [np.sqrt((0.04 + 400 * 0.012**2) / 0.08) - 1, np.sqrt((0.16 + 0.0036) / 0.15) - 1]
    )
    for run in rig["runs"]:
        assert run["above_bound"] == pytest.approx(run["acceleration"] / run["bound"] - 1)
    assert [run["label"]["variant"] for run in rig["runs"]] == ["soft", "hard"]
    assert [run["best"] is None for run in rig["runs"]] == [False, True]
    assert (folder / "pareto.png").exists()


def test_a_run_below_the_bound_is_told(compared):
    assert "seat (soft) is below its bound, which holds for dampers without hysteresis" in compared(Beaten)[1]


@pytest.mark.parametrize(("kind", "reason"), [(Refused, "no bracket: the seat is bent"), (Interrupted, "interrupted")])
def test_the_rest_is_kept_without_a_bracket(compared, kind, reason):
    _, said, folder = compared(kind)
    assert reason in said
    assert (folder / "pareto.png").exists() and not (folder / "brackets.json").exists()
