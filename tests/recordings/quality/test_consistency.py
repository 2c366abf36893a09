"""A fault is named where its correction takes the contradiction away, with the channel and what is wrong."""

import numpy as np
import pytest

from seatsim.recordings.quality.issue import RunUnderTest
from seatsim.recordings.quality.relations import check_consistency, check_exchanged_currents
from seatsim.recordings.recording import load_recording


@pytest.fixture(scope="module")
def run(sound):
    recording = load_recording(sound)
    return RunUnderTest("run-1", recording.table("run-1"), recording, recording.nominal)


def with_channel(run, **channels):
    return run._replace(table={**run.table, **channels})


def test_a_sound_run_contradicts_nothing(run):
    assert list(check_consistency(run)) == [] and list(check_exchanged_currents(run)) == []


@pytest.mark.parametrize(
    ("channel", "seconds", "severity", "words"),
    [
        ("coil_current", 0.16, "warning", "is 0.16 s late"),
        ("driver_acceleration", 0.1, "error", "is 0.1 s late"),
        ("driver_acceleration", -0.1, "error", "is 0.1 s early"),
        # What a sensor or a clock may do is no fault of the data.
        ("driver_acceleration", 0.048, None, ""),
        ("coil_current", 0.096, None, ""),
    ],
)
def test_a_late_coil_current_is_a_warning_and_a_late_motion_an_error(run, channel, seconds, severity, words):
    late = np.roll(run.table[channel], round(seconds * run.rate))
    found = list(check_consistency(with_channel(run, **{channel: late})))
    expected = [(severity, "late", channel)] if severity else []
    assert [(issue.severity, issue.kind, issue.channel) for issue in found] == expected
    assert all(words in issue.sentence for issue in found)


@pytest.mark.parametrize(("channel", "factor"), [("damper_force", 1.3), ("frame_acceleration", 0.8)])
def test_a_calibration_error_is_no_fault_of_the_data(run, channel, factor):
    assert list(check_consistency(with_channel(run, **{channel: factor * run.table[channel]}))) == []


def test_exchanged_currents_are_told_by_the_coil_alone(run):
    table = run.table
    swapped = with_channel(run, current_command=table["coil_current"], coil_current=table["current_command"])
    (issue,) = check_exchanged_currents(swapped)
    assert (issue.kind, issue.severity, issue.channel) == ("exchange", "error", "current_command")
    assert "current_command and coil_current: are exchanged" in issue.sentence
