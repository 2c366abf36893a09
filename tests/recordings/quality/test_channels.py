"""Faults that the values of one channel show: constant, out of range, clipped, stuck, held."""

import numpy as np
import pytest

from seatsim.recordings.quality.channels import check_ranges, check_shapes

RATE = 250.0
TIME = np.arange(2500) / RATE
NOISE = {"frame_acceleration": 0.03, "floor_acceleration": 0.01, "damper_temperature": 0.1, "damper_force": 2.5}
MOVING = 2.0 * np.sin(2 * np.pi * 1.3 * TIME) + 0.03 * np.random.default_rng(1).standard_normal(len(TIME))


def kinds(check, run):
    return [(issue.severity, issue.kind, issue.channel) for issue in check(run)]


@pytest.mark.parametrize(
    ("channel", "values", "expected"),
    [
        ("frame_acceleration", np.full(2500, 0.3), [("error", "constant")]),
        ("damper_temperature", np.full(2500, 21.0), [("warning", "constant")]),
        ("current_command", np.full(2500, 0.5), []),
        ("frame_acceleration", 0.02 * MOVING, [("warning", "silent")]),
        ("floor_acceleration", 0.002 * MOVING, []),
        ("coil_current", 0.5 + 0.2 * MOVING, []),
        ("coil_current", 0.6 + 0.4 * MOVING, [("warning", "range")]),
        ("coil_current", 31.0 * np.abs(MOVING), [("error", "unit")]),
        ("current_command", -0.3 * np.abs(MOVING), [("error", "sign")]),
    ],
)
def test_ranges(under_test, channel, values, expected):
    run = under_test({channel: values}, RATE, NOISE)
    assert kinds(check_ranges, run) == [(*found, channel) for found in expected]


def test_flat_tops_are_errors_where_many_rows_stand_there_and_warnings_where_few_do(under_test):
    spike = np.where(np.abs(np.arange(2500) - 1000) < 3, 4.0, MOVING)
    for clipped, limit, severity in ((np.minimum(MOVING, 1.5), 1.5, "error"), (spike, 4.0, "warning")):
        found = list(check_shapes(under_test({"frame_acceleration": clipped}, RATE, NOISE)))
        assert [(issue.severity, issue.kind) for issue in found] == [(severity, "clipped")]
        assert f"{np.sum(clipped == limit)} rows stand at its extreme {limit:.4g}" in found[0].sentence


def test_held_values_are_told_with_their_rows_unless_they_are_coarser_than_the_noise(under_test):
    held = np.repeat(MOVING[::4], 4)
    (issue,) = check_shapes(under_test({"frame_acceleration": held}, RATE, NOISE))
    assert (issue.severity, issue.kind) == ("warning", "held") and "for 4 rows" in issue.sentence
    coarse = np.round(np.repeat(MOVING[::4], 4), 1)
    assert kinds(check_shapes, under_test({"frame_acceleration": coarse}, RATE, NOISE)) == []


def test_a_travel_that_friction_holds_is_neither_stuck_nor_dead_nor_clipped(under_test):
    """Of a coarse sensor with less noise than was stated of it."""
    floor = MOVING
    held = np.round(np.where(np.arange(2500) % 700 < 400, 1.0, MOVING), 1)
    for travel, expected in ((held, "clipped"), (0.0 * MOVING, "constant")):
        table = {"floor_acceleration": floor, "suspension_displacement": travel}
        run = under_test(table, RATE, {"floor_acceleration": 0.01, "suspension_displacement": 0.2})
        issues = [*check_ranges(run), *check_shapes(run)]
        assert {(each.severity, each.kind) for each in issues} <= {("warning", expected)}


@pytest.mark.parametrize(("command", "severity"), [(1.0, "error"), (-1.0, "warning"), (0.0, "warning")])
def test_a_negative_current_has_the_wrong_sign_only_where_it_opposes_its_command(under_test, command, severity):
    swing = 0.2 + 0.1 * np.sin(np.arange(2500) / 50.0)
    run = under_test({"coil_current": -swing - 0.2, "current_command": 0.3 + command * (swing - 0.2)}, RATE)
    (issue,) = check_ranges(run)
    assert (issue.severity, issue.kind) == (severity, "sign")
