"""What is wrong with whole runs: clock, length, duplicates, repeats, rest, noise and degrees Fahrenheit."""

import dataclasses

import numpy as np
import pandas as pd
import pytest

from seatsim.recordings.quality.runs import check_all_runs, check_clock

RATE = 250.0


def motion(seed, seconds=12.0):
    return np.random.default_rng(seed).standard_normal(round(seconds * RATE))


def found(*runs):
    return [(issue.severity, issue.kind, issue.run) for issue in check_all_runs(runs)]


def said(*runs):
    return " ".join(issue.sentence for issue in check_all_runs(runs))


@pytest.fixture
def runs(under_test):
    """Two runs of white motion, whose noise is stated as it is."""
    noise, rows = dict.fromkeys(("floor_acceleration", "driver_acceleration"), 1.0), np.arange(3000)
    swings = [
        [9.0 * np.sin(rows / (slow + k)) + motion(k + seed) for slow, seed in ((20.0, 0), (30.0, 5))] for k in (0, 1)
    ]
    tables = [dict(zip(noise, swing, strict=True)) for swing in swings]
    return [under_test(table, RATE, noise, name) for table, name in zip(tables, "ab", strict=True)]


def test_a_single_run_and_a_duplicate_are_named(runs):
    assert found(runs[0]) == [("warning", "single", "a")] and "is the only run" in said(runs[0])
    twice = runs[0], runs[1]._replace(table=runs[0].table)
    assert ("error", "duplicate", "b") in found(*twice) and "b: holds the same rows as a" in said(*twice)


def test_a_repeat_may_be_shifted_but_not_another_motion(runs):
    first, second = runs
    named = {"b": second.recording.runs["b"]._replace(repeat_of="a")}
    second = second._replace(recording=dataclasses.replace(second.recording, runs=named))
    assert ("error", "repeat", "b") in found(first, second) and "b: is no repeat of a" in said(first, second)
    shifted = {name: np.roll(values, 100) + 0.1 * motion(9) for name, values in first.table.items()}
    assert found(first, second._replace(table=shifted)) == []


def test_a_run_at_rest_is_a_warning_all_at_rest_an_error_and_a_dead_floor_an_error(runs):
    first, second = runs
    still = {name: motion(7 + k) for k, name in enumerate(first.table)}
    assert found(first, second._replace(table=still)) == [("warning", "still", "b")]
    assert "nothing moves" in said(first, second._replace(table=still))
    other = {name: motion(17 + k) for k, name in enumerate(first.table)}
    resting = found(first._replace(table=other), second._replace(table=still))
    assert resting == [("error", "still", "a"), ("error", "still", "b")]
    dead = {**second.table, "floor_acceleration": motion(3)}
    assert found(first, second._replace(table=dead)) == [("error", "still", "b")]


@pytest.mark.parametrize(("factor", "is_said"), [(0.3, True), (0.5, False), (2.5, False), (4.5, True)])
def test_noise_is_said_where_it_is_more_than_three_times_off(runs, factor, is_said):
    """White noise of a size that is `factor` times what is stated."""
    for run in runs:
        entry = run.recording.channels["driver_acceleration"]
        run.recording.channels["driver_acceleration"] = entry._replace(noise_rms=1.0 / factor)
    assert (("warning", "noise", None) in found(*runs)) is is_said


@pytest.mark.parametrize(
    ("clock", "expected"),
    [
        (lambda t: t, []),
        (lambda t: 2.0 * t, [("error", "rate")]),
        (lambda t: 1.01 * t, [("error", "rate")]),
        (lambda t: t + 0.04 * (t > 3.0), [("warning", "jump")]),
        (lambda t: t + 0.4 * (t > 3.0), [("error", "jump")]),
    ],
)
def test_a_clock_is_held_against_the_sample_rate(runs, tmp_path, clock, expected):
    run = runs[0]._replace(recording=dataclasses.replace(runs[0].recording, folder=tmp_path))
    pd.DataFrame({"time": clock(np.arange(3000) / RATE), **run.table}).to_csv(tmp_path / "a.csv", index=False)
    issues = list(check_clock(run))
    assert [(issue.severity, issue.kind) for issue in issues] == expected
    assert all("3.00" in issue.sentence for issue in issues if issue.kind == "jump")
