"""Joined doses, the method that shocks demand, a day's exposure, zones, totals and SEAT of several runs."""

import math

import numpy as np
import pytest

from seatsim.metrics.comfort import dose, find_shocks, join_doses, motion_sickness_dose, seat_transmission
from seatsim.metrics.exposure import DIRECTIONS, assess_exposure
from seatsim.metrics.motion import rms
from seatsim.metrics.weighting import weight
from seatsim.schema.errors import InputError

RATE = 500.0


def sine(amplitude, duration=60.0, frequency=5.0):
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(int(duration * RATE)) / RATE)


def test_joined_doses_are_those_of_the_whole():
    rng = np.random.default_rng(1)
    x = rng.normal(size=30000)
    parts = join_doses([dose(x[:7000], RATE), dose(x[7000:], RATE)])
    whole = dose(x, RATE)
    for name in ("duration", "rms", "vdv", "estimated_vdv", "crest_factor", "vdv_ratio"):
        assert getattr(parts, name) == pytest.approx(getattr(whole, name), rel=1e-12)
    # The running RMS does not run across a cut.
    assert parts.mtvv == max(dose(x[:7000], RATE).mtvv, dose(x[7000:], RATE).mtvv)


def test_steady_vibration_needs_no_additional_method_and_shocks_do():
    assert find_shocks(dose(sine(1.0), RATE)) == []
    shocks = sine(0.1)
    shocks[15000:15010] = 5.0
    reasons = " ".join(find_shocks(dose(shocks, RATE)))
    assert "crest factor" in reasons and "MTVV / a_w" in reasons and "VDV" in reasons
    # A stretch ten times as strong as the rest has a low crest factor, but a transient.
    stretch = np.concatenate([sine(0.1, 55.0), sine(1.0, 5.0)])
    reasons = [reason.split(" of ")[0] for reason in find_shocks(dose(stretch, RATE))]
    assert reasons == ["MTVV / a_w", "VDV / (a_w T^(1/4))"]


def test_exposure_of_a_sine_is_analytic(conform):
    # a_w = 1 m/s^2 on x, of which the directive takes 1.4 times; 1 on z.
    doses = {"x": dose(sine(math.sqrt(2)), RATE), "z": dose(sine(math.sqrt(2)), RATE)}
    found = assess_exposure(doses, hours=2.0)
    assert found.a8_axis == found.vdv8_axis == "x"
    for name, figure, expected in (
        ("A(8), m/s^2", found.a8, 1.4 * math.sqrt(2 / 8)),
        ("VDV of the day, m/s^1.75", found.vdv8, 1.4 * 1.5**0.25 * 7200**0.25),
        ("hours to the action value 0.5 m/s^2", found.action_value.hours_to_a8, 8 * (0.5 / 1.4) ** 2),
        ("hours to the action value 9.1 m/s^1.75", found.action_value.hours_to_vdv, (9.1 / 1.4) ** 4 / 1.5 / 3600),
        ("hours to the limit value 1.15 m/s^2", found.limit_value.hours_to_a8, 8 * (1.15 / 1.4) ** 2),
        ("hours to the limit value 21 m/s^1.75", found.limit_value.hours_to_vdv, (21 / 1.4) ** 4 / 1.5 / 3600),
    ):
        claim = f"sine of 1 m/s^2 RMS on x and z for 2 h: {name}"
        conform(claim, "directive 2002/44/EC, 1.4 on x", figure, expected, tolerance=1e-6 * expected)
    assert (found.action_value.exceeded_by_a8, found.limit_value.exceeded_by_a8) == (True, False)
    at_limit = assess_exposure(doses, found.limit_value.hours_to_a8)
    assert at_limit.a8 == pytest.approx(1.15)


def test_nothing_is_reached_at_rest_and_no_axis_of_health_means_no_exposure():
    found = assess_exposure({"z": dose(np.zeros(1000), RATE)}, hours=8.0)
    assert (found.a8, found.action_value.hours_to_a8, found.zone_a8) == (0.0, math.inf, "below")
    assert assess_exposure({"back.x": dose(sine(1.0), RATE)}, 8.0) is None
    with pytest.raises(InputError, match="hours"):
        assess_exposure({"z": dose(sine(1.0), RATE)}, 0.0)


@pytest.mark.parametrize(
    ("a_w", "hours", "zone_a8", "zone_vdv"),
    [
        (0.42, 8, "below", "below"),
        (0.45, 8, "within", "below"),
        (0.5, 8, "within", "within"),
        (0.95, 8, "above", "above"),
        (0.85, 4, "within", "within"),
        (5.9, 1 / 6, "within", "above"),
    ],
)
def test_zones_meet_between_four_and_eight_hours(a_w, hours, zone_a8, zone_vdv):
    found = assess_exposure({"z": dose(sine(a_w * math.sqrt(2)), RATE)}, hours)
    assert (found.zone_a8, found.zone_vdv) == (zone_a8, zone_vdv)


def test_motion_sickness_dose_grows_with_the_root_of_time(conform):
    time = np.arange(0, 400, 0.1)
    weighted = weight(np.sin(2 * np.pi * 0.2 * time), 10.0, "Wf")
    found, expected = motion_sickness_dose(rms(weighted[2000:]), 200.0), 0.992 * math.sqrt(200 / 2)
    claim = "motion sickness dose of a sine of 0.2 Hz over 200 s, m/s^1.5"
    conform(claim, "ISO 2631-1: Wf 0.992, root of the time", found, expected, tolerance=2e-3 * expected)


def test_seat_of_three_runs_says_whether_they_agree():
    base = [dose(sine(a), RATE) for a in (1.0, 1.02, 0.98)]
    seat = [dose(sine(0.7 * a), RATE) for a in (1.0, 1.02, 0.98)]
    found = seat_transmission(seat, base)
    assert (found.rms, found.vdv) == (pytest.approx(0.7), pytest.approx(0.7))
    assert found.spread == pytest.approx(0.02) and found.within_spread is True
    apart = seat_transmission([dose(sine(0.7 * a), RATE) for a in (1.0, 1.02, 1.15)], base)
    assert apart.within_spread is False
    assert seat_transmission(seat[:2], base[:2]).within_spread is None


def test_directions_are_those_of_the_standard():
    printed = {"back.x": "Wc 0.8", "back.y": "Wd 0.5", "back.z": "Wd 0.4"}
    printed |= {"feet.x": "Wk 0.25", "feet.y": "Wk 0.25", "feet.z": "Wk 0.4"}
    assert {axis: f"{d.weighting} {d.comfort}" for axis, d in DIRECTIONS.items() if "." in axis} == printed
