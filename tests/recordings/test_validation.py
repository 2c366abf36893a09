"""The comparison error of a channel and its uncertainty are those computed by hand where the force is linear."""

import numpy as np
import pandas as pd
import pytest

import seatsim
from seatsim.metrics.objective_rating import rate_agreement
from seatsim.recordings.recording import load_recording
from seatsim.recordings.replay import replay
from seatsim.schema.content import to_content

from ..text import beside

RATE, DAMPING = 1000.0, 800.0
RUNS = {"a": (3, 0.1), "b": (6, 0.05)}
"""Seconds, and peak speed in m/s of a sine of 1 Hz."""
NOMINAL = beside(__file__, "validated_nominal.yaml")
HEADER = beside(__file__, "validated_header.yaml")


@pytest.fixture
def bench(tmp_path):
    """Return a function that records sines of a damper with less damping than its nominal has."""

    def make(tolerance="0.0", noise=0.0):
        for run, (seconds, speed) in RUNS.items():
            phase = 2.0 * np.pi * np.arange(seconds * 1000) / RATE
            x, v = speed / (2.0 * np.pi) * np.sin(phase), speed * np.cos(phase)
            columns = {"displacement": x, "velocity": v, "damper_force": DAMPING * v, "current_command": 0.0 * x}
            pd.DataFrame(columns).to_csv(tmp_path / f"{run}.csv", index=False)
        (tmp_path / "nominal.yaml").write_text(NOMINAL)
        (tmp_path / "recording.yaml").write_text(HEADER % (tolerance, noise))
        return seatsim.gap(tmp_path / "nominal.yaml", tmp_path).v_and_v["damper_force"]

    return make


def test_the_parts_of_a_linear_force_are_those_by_hand(bench):
    # Without its first second, run a counts two seconds and run b five.
    speed = np.sqrt((2 * 0.1**2 + 5 * 0.05**2) / 7 / 2)
    found = bench("0.05")
    assert found.unit == "N" and found.u_d == 2.0 and found.u_num < 1e-6
    assert found.error == pytest.approx(200.0 * speed, rel=1e-6)
    assert found.u_input == pytest.approx(0.05 * 1000.0 / np.sqrt(3.0) * speed, rel=1e-6)
    assert found.u_val == pytest.approx(np.sqrt(found.u_num**2 + found.u_input**2 + 4.0))
    noisy = bench("0.05", noise=0.002)
    assert noisy.u_input == pytest.approx(np.hypot(found.u_input, 1000.0 * 0.002), rel=0.02)


def test_what_was_fitted_adds_nothing(bench):
    assert bench("fitted").u_input == 0.0


def test_a_gap_holds_the_means_of_the_ratings_over_the_runs(sound, sound_gap):
    found, recording = sound_gap, load_recording(sound)
    assert list(found.iso18571) == list(found.v_and_v) == list(found.channels)
    for name, rating in found.iso18571.items():
        each = [
            rate_agreement(measured[name], simulated[name], 250.0)
            for measured, simulated in (replay(recording.nominal, recording, run) for run in recording.runs)
        ]
        assert rating == pytest.approx(np.mean(each, axis=0))
    content = to_content(found)
    assert set(content["iso18571"]["damper_force"]) == {*rating._fields, "overall"}
    assert set(content["v_and_v"]["damper_force"]) == {"unit", "error", "u_num", "u_input", "u_d", "u_val"}


def test_the_error_of_a_right_scenario_is_its_uncertainty(sound_gap):
    for each in sound_gap.v_and_v.values():
        assert 0.98 * each.u_d < each.error < 1.1 * each.u_val


def test_a_run_at_rest_is_not_rated(copy):
    rewritten = pd.read_csv(copy / "run-2.csv.gz")
    rewritten.assign(coil_current=0.0, current_command=0.0).to_csv(copy / "run-2.csv.gz", index=False)
    found, alone = (seatsim.gap(copy / "nominal.yaml", copy, runs) for runs in ((), ("run-1",)))
    assert found.iso18571["coil_current"] == alone.iso18571["coil_current"]
