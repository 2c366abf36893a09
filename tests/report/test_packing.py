"""Signals on a page: no peak is lost, values come back as they were, and a page stays small."""

import base64

import numpy as np
import pytest

from seatsim.report.packing import BUDGET, BYTES, Axis, Panel, pack_line, pack_signals, reduce_line
from seatsim.report.planes import Curve, Range, draw_cells, draw_curves, find_range, list_ticks


def unpack(line):
    whole = np.frombuffer(base64.b64decode(line["bits"]), "<i2")
    return np.where(whole == -32768, np.nan, line["at"] + line["step"] * whole)


def test_a_packed_line_comes_back_to_a_65000th_of_its_range():
    values = np.array([-3.0, np.nan, 12.0, 0.1])
    np.testing.assert_allclose(unpack(pack_line(values)), values, atol=15 / 65000)
    np.testing.assert_allclose(unpack(pack_line(np.full(4, 7.5))), 7.5)
    assert np.isnan(unpack(pack_line(np.full(2, np.nan)))).all()


def test_a_reduced_line_keeps_every_peak_in_its_place():
    values = np.random.default_rng(0).standard_normal(12_001)
    values[7003], values[7011] = 50.0, -60.0
    short = reduce_line(values, 2400)
    assert len(short) <= 2400 and short.max() == 50.0 and short.min() == -60.0
    assert abs(int(short.argmax()) / len(short) - 7003 / 12_001) < 2e-3
    assert reduce_line(values[:100], 2400) is not None and len(reduce_line(values[:100], 2400)) == 100


def test_reduced_values_stand_at_the_time_of_their_interval():
    time = np.arange(24_000) / 1000
    panel = Panel("damper_force", "N", "", {"": [time]})
    packed = pack_signals("signals-time", "", [("ramp", 0)], Axis("time", "s", {"": time}), [panel])
    [axis], values = packed.data["runs"], unpack(packed.data["panels"][0]["runs"][0][0])
    shown = axis["first"] + axis["step"] * np.arange(len(values))
    np.testing.assert_allclose(shown, values, atol=0.02)
    assert "every 20 ms" in packed.caption


def test_seven_channels_of_three_runs_fit_into_the_budget():
    time = np.arange(12_000) / 500
    values = {run: [np.sin(time + k) for k in range(3)] for run in "abc"}
    panels = [Panel(f"channel_{k}", "N", "", values) for k in range(7)]
    packed = pack_signals(
        "signals-time", "", [("x", k) for k in range(3)], Axis("t", "s", dict.fromkeys("abc", time)), panels
    )
    size = sum(len(line["bits"]) for panel in packed.data["panels"] for run in panel["runs"] for line in run)
    assert 0.5 * BUDGET < size < 1.05 * BUDGET and pytest.approx(8 / 3) == BYTES


def test_ticks_are_round_and_inside():
    assert [tick.text for tick in list_ticks(Range(-0.3, 1.2))] == ["0.0", "0.5", "1.0"]
    assert [tick.text for tick in list_ticks(Range(-1200.0, 1300.0))] == ["−1000", "−500", "0", "500", "1000"]
    assert all(0 <= tick.at <= 100 for tick in list_ticks(find_range(np.array([3.0, 3.0]))))


def test_a_plane_without_finite_points_says_so():
    plane = draw_curves("t", "c", ("x", "y"), [Curve("a", np.array([np.nan]), np.array([1.0]), 0)])
    assert plane.empty and not plane.shapes


def test_a_gap_in_a_line_lifts_the_pen():
    x, y = np.arange(5.0), np.array([0.0, 1.0, np.nan, 1.0, 0.0])
    [shape] = draw_curves("t", "c", ("x", "y"), [Curve("a", x, y, 0)]).shapes
    assert shape.path.count("M") == 2 and shape.path.count("L") == 2


def test_cells_are_shaded_by_the_logarithm():
    borders = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0])
    plane = draw_cells("t", ("x", "y"), borders, np.array([[1.0, np.nan]]), Range(0.01, 1.0), "mm")
    [shape] = plane.shapes
    assert shape.look == 9 and shape.path == "M0 1000H500V0H0Z"
