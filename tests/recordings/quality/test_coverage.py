"""What a recording visited, and what it cannot judge."""

import numpy as np
import pytest

import seatsim
from seatsim.recordings.quality.coverage import measure_coverage
from seatsim.recordings.recording import load_recording

from ...faulty_recordings import FEEDBACK, RATE, rewrite


def test_coverage_says_what_was_visited_and_what_was_not(copy):
    seen = measure_coverage(load_recording(copy))
    assert seen.seconds == pytest.approx(16.0, abs=0.1)
    assert set(seen.visited) == {"travel", "velocity", "current", "temperature", "driver"}
    table = load_recording(copy).table("run-1")
    assert seen.visited["travel"].high >= np.max(table["suspension_displacement"])
    assert "no run is warmer than 20 degC: thermal fade cannot be assessed" in seen.missing
    rewrite(copy, lambda f: f.assign(coil_current=0.4 + 0.01 * np.sin(f.time), damper_temperature=60.0))
    missing = " ".join(measure_coverage(load_recording(copy)).missing)
    assert "current stays at 0.39 to 0.41 A: coil, remanence" in missing
    assert "thermal fade" not in missing


def test_the_velocity_of_coverage_is_that_of_the_rig(kept_seat_file, sound):
    result = seatsim.run(kept_seat_file, {**FEEDBACK, "solver": {"step": 1.0 / RATE}})
    fast = np.max(np.abs(result["suspension_velocity"]))
    edges = measure_coverage(load_recording(sound)).visited["velocity"]
    assert max(-edges.low, edges.high) == pytest.approx(fast, rel=0.4)
