"""Gravity in accelerometers is taken out of every table, other offsets are left to the diagnosis."""

import shutil

import numpy as np
import pytest

from seatsim.diagnosis.problem import pose_problem
from seatsim.recordings.gap import gap
from seatsim.recordings.quality.sensors import without_gravity
from seatsim.recordings.recording import load_recording

from ...diagnosis.builders import SerialExecutor
from ...faulty_recordings import rewrite

PULLED = {"floor_acceleration": 9.81, "frame_acceleration": 9.9, "driver_acceleration": -9.7}


@pytest.fixture
def heavy(sound, tmp_path):
    """The sound recording with gravity in all accelerometers, upside down at the driver, and an offset beside it."""
    folder = tmp_path / "heavy"
    shutil.copytree(sound, folder)
    rewrite(folder, lambda f: f.assign(**{channel: f[channel] + pull for channel, pull in PULLED.items()}))
    return folder


def test_the_tables_are_without_the_constant_of_all_runs_together(heavy):
    raw, clean = load_recording(heavy), without_gravity(load_recording(heavy))
    assert set(clean.removed) == set(PULLED)
    for name, constant in clean.removed.items():
        pooled = np.concatenate([clean.table(run)[name] for run in clean.runs])
        assert abs(np.mean(pooled)) < 1e-12
        for run in clean.runs:
            np.testing.assert_allclose(raw.table(run)[name] - clean.table(run)[name], constant)
    assert raw.removed == {} and "damper_force" not in clean.removed
    # What is without it already is left as it is.
    assert without_gravity(clean).removed == clean.removed


@pytest.mark.parametrize(("mean", "is_gravity"), [(9.4, True), (9.2, False), (10.2, True)])
def test_a_few_percent_tell_gravity_from_an_offset(sound, tmp_path, mean, is_gravity):
    folder = tmp_path / "one"
    shutil.copytree(sound, folder)
    rewrite(folder, lambda f: f.assign(frame_acceleration=f.frame_acceleration + mean))
    assert bool(without_gravity(load_recording(folder)).removed) is is_gravity


def test_gap_and_problem_are_those_without_gravity(heavy, sound, sound_gap):
    first = gap(heavy / "nominal.yaml", heavy)
    # The little that the floor truly has of a mean in 16 s is lost with gravity.
    assert first.channels == pytest.approx(sound_gap.channels, abs=0.03)
    assert sum("is gravity, which is taken out" in note for note in first.notes) == 3
    posed, reference = (pose_problem(load_recording(folder), SerialExecutor()) for folder in (heavy, sound))
    run = posed.runs[0]
    floor, expected = (each.inputs[run].floor.acceleration for each in (posed, reference))
    np.testing.assert_allclose(floor, expected, atol=0.02)
    np.testing.assert_allclose(posed.measured[run], reference.measured[run], atol=0.02)
    assert posed.recording.removed
