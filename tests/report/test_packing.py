"""Signals on a page: no peak is lost, values come back as they were, and a page stays small."""

import base64
import zlib

import numpy as np
import pytest

from seatsim.report.packing import BUDGET, Panel, pack_line, pack_signals


def unpack(line):
    low, high = np.frombuffer(zlib.decompress(base64.b64decode(line["bits"])), np.uint8).reshape(2, -1).astype("<u2")
    whole = np.cumsum((low | high << 8).astype("<i2"), dtype="<i2")
    return np.where(whole == -32768, np.nan, line["at"] + line["step"] * whole)


def test_a_packed_line_comes_back_to_a_65000th_of_its_range():
    values = np.array([-3.0, np.nan, 12.0, 0.1])
    np.testing.assert_allclose(unpack(pack_line(values)), values, atol=15 / 65000)
    np.testing.assert_allclose(unpack(pack_line(np.full(4, 7.5))), 7.5)
    assert np.isnan(unpack(pack_line(np.full(2, np.nan)))).all()


def test_all_values_stay_where_there_is_room():
    time = np.arange(60_000) / 1000
    panels = [Panel(f"channel_{k}", "N", {"": [np.sin((k + 1) * time)]}) for k in range(6)]
    packed = pack_signals("", [("sine", 0)], {"": time}, panels)
    values = unpack(packed.data["panels"][2]["runs"][0][0])
    np.testing.assert_allclose(values, np.sin(3 * time), atol=1e-4)
    assert packed.data["runs"] == [{"first": 0.0, "step": pytest.approx(0.001)}] and packed.caption == ""


def test_reduced_values_stand_at_the_time_of_their_interval():
    time = np.arange(24_000) / 1000
    noise = np.random.default_rng(0).standard_normal((40, len(time)))
    panel = Panel("damper_force", "N", {"": [time, *noise]})
    packed = pack_signals("", [("ramp", 0), *[("noise", 1)] * 40], {"": time}, [panel])
    [axis], values = packed.data["runs"], unpack(packed.data["panels"][0]["runs"][0][0])
    shown = axis["first"] + axis["step"] * np.arange(len(values))
    np.testing.assert_allclose(shown, values, atol=0.02)
    assert len(values) < len(time) and "largest value in every" in packed.caption


def test_noise_is_reduced_until_it_fits_into_the_budget():
    time, rng = np.arange(12_000) / 500, np.random.default_rng(1)
    values = {run: [rng.standard_normal(len(time)) for _ in range(3)] for run in "abc"}
    panels = [Panel(f"channel_{k}", "N", values) for k in range(7)]
    packed = pack_signals("", [("x", k) for k in range(3)], dict.fromkeys("abc", time), panels)
    size = sum(len(line["bits"]) for panel in packed.data["panels"] for run in panel["runs"] for line in run)
    assert 0.5 * BUDGET < size <= BUDGET
