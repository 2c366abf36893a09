"""Signals on a page: no peak is lost, values come back as they were, and a page stays small."""

import base64

import numpy as np
import pytest

from seatsim.report.packing import BUDGET, BYTES, Panel, pack_line, pack_signals


def unpack(line):
    whole = np.frombuffer(base64.b64decode(line["bits"]), "<i2")
    return np.where(whole == -32768, np.nan, line["at"] + line["step"] * whole)


def test_a_packed_line_comes_back_to_a_65000th_of_its_range():
    values = np.array([-3.0, np.nan, 12.0, 0.1])
    np.testing.assert_allclose(unpack(pack_line(values)), values, atol=15 / 65000)
    np.testing.assert_allclose(unpack(pack_line(np.full(4, 7.5))), 7.5)
    assert np.isnan(unpack(pack_line(np.full(2, np.nan)))).all()


def test_reduced_values_stand_at_the_time_of_their_interval():
    time = np.arange(24_000) / 1000
    panel = Panel("damper_force", "N", "", {"": [time]})
    packed = pack_signals("", [("ramp", 0)], {"": time}, [panel])
    [axis], values = packed.data["runs"], unpack(packed.data["panels"][0]["runs"][0][0])
    shown = axis["first"] + axis["step"] * np.arange(len(values))
    np.testing.assert_allclose(shown, values, atol=0.02)
    assert "every 20 ms" in packed.caption


def test_seven_channels_of_three_runs_fit_into_the_budget():
    time = np.arange(12_000) / 500
    values = {run: [np.sin(time + k) for k in range(3)] for run in "abc"}
    panels = [Panel(f"channel_{k}", "N", "", values) for k in range(7)]
    packed = pack_signals("", [("x", k) for k in range(3)], dict.fromkeys("abc", time), panels)
    size = sum(len(line["bits"]) for panel in packed.data["panels"] for run in panel["runs"] for line in run)
    assert 0.5 * BUDGET < size < 1.05 * BUDGET and pytest.approx(8 / 3) == BYTES
