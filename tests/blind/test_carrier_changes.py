"""What is put into a recording is what its label says: the effect of that name and size takes the gap away again."""

import numpy as np
import pytest

from seatsim.blind.carrier.make import Ruler, draw_amount, draw_changes
from seatsim.blind.sealed import EFFECTS

from .carriers import RATE, bench_carrier, offset, seat_carrier

SIZE = 0.1
LEFT = 0.4
FIXED = {"sensor.clock_skew": {"hold": 1.0 / RATE}}


def put_in(carrier, effect, form="", channel=""):
    changes = draw_changes(carrier, np.random.default_rng(0))
    chosen = [c for c in changes if c.effect == effect and form in c.form and c.channel == channel]
    drawn = draw_amount(Ruler(carrier), chosen[0], SIZE)
    assert drawn is not None
    return drawn


def share_left(carrier, drawn):
    """Return the gap with the effect in the nominal over that without, both above the untouched one."""
    ruler, altered = Ruler(carrier), drawn.altered.carrier
    parameters = {**drawn.altered.parameters, **FIXED.get(drawn.change.effect, {})}
    if drawn.change.channel:
        parameters["channel"] = drawn.change.channel
    effects = [*altered.nominal.get("effects", []), {"effect": drawn.change.effect, "parameters": parameters}]
    mended = altered._replace(nominal={**altered.nominal, "effects": effects})
    before, after = (ruler.residuals(each) for each in (altered, mended))
    squares = [[np.mean((each[name] / ruler.spread[name]) ** 2) for name in ruler.before] for each in (before, after)]
    return np.sqrt(np.mean(squares[1]) / np.mean(squares[0]))


@pytest.mark.parametrize(
    ("make", "effect", "form", "channel"),
    [
        (bench_carrier, "damper.seal_friction", "", ""),
        (bench_carrier, "sensor.gain", "", "damper_force"),
        (bench_carrier, "sensor.bias", "drift", "damper_force"),
        (bench_carrier, "sensor.lag", "", "displacement"),
        (bench_carrier, "sensor.clock_skew", "", ""),
        (bench_carrier, "coil.delay", "", ""),
        (seat_carrier, "suspension.progressive_spring", "", ""),
        (seat_carrier, "driver.mass", "", ""),
        (seat_carrier, "sensor.gain", "", "driver_acceleration"),
        (seat_carrier, "sensor.lag", "", "floor_acceleration"),
    ],
)
def test_the_named_effect_takes_the_gap_away(make, effect, form, channel):
    carrier = make()
    drawn = put_in(carrier, effect, form, channel)
    assert drawn.size == pytest.approx(SIZE, rel=0.45) or make is seat_carrier
    assert share_left(carrier, drawn) < LEFT


def test_in_a_play_the_recorded_motion_runs_ahead_of_the_force_by_half_the_gap():
    carrier = bench_carrier()
    altered = put_in(carrier, "damper.free_play").altered
    for run, table in carrier.tables.items():
        shown, force = altered.carrier.tables[run], table["damper_force"]
        ahead = shown["displacement"] - table["displacement"]
        assert np.array_equal(shown["damper_force"], force)
        strong = np.abs(force) > 0.3 * np.std(carrier.pooled("damper_force"))
        assert np.allclose(np.ptp(ahead), altered.parameters["gap"])
        assert np.allclose((ahead - ahead[force > 0].max())[strong & (force > 0)], 0.0)


def test_with_a_logged_coil_a_limit_is_what_flowed_and_the_log_may_run_ahead():
    carrier = bench_carrier(logged_coil=True)
    drawn = put_in(carrier, "coil.current_limit")
    assert drawn.altered.parameters["limit"] == pytest.approx(1.0)
    assert share_left(carrier, drawn) < LEFT
    forms, without = (
        {change.form for seed in range(8) for change in draw_changes(each, np.random.default_rng(seed))}
        for each in (carrier, bench_carrier())
    )
    assert {"late log", "early log"} < forms and "early log" not in without


def test_every_change_has_a_name_of_the_contract_and_leaves_the_carrier_as_it_was():
    for carrier in (bench_carrier(), bench_carrier(logged_coil=True), seat_carrier()):
        before = {run: {name: values.copy() for name, values in table.items()} for run, table in carrier.tables.items()}
        for change in draw_changes(carrier, np.random.default_rng(1)):
            assert change.effect in EFFECTS
            change.alter(change.largest / 2)
        for run, table in carrier.tables.items():
            assert all(np.array_equal(values, before[run][name]) for name, values in table.items())


def test_a_size_counts_in_standard_deviations_beyond_the_tolerance():
    carrier = bench_carrier()
    spread = float(np.std(carrier.pooled("damper_force")))
    assert Ruler(carrier).size(offset(carrier, 0.1 * spread)) == pytest.approx(0.1, rel=1e-3)
    tables = {run: {**t, "damper_force": 1.08 * t["damper_force"]} for run, t in carrier.tables.items()}
    known, loose = (bench_carrier(tolerance)._replace(tables=tables) for tolerance in (0.0, 0.1))
    assert Ruler(bench_carrier(0.0)).size(known) == pytest.approx(0.08, rel=0.05)
    assert Ruler(bench_carrier(0.1)).size(loose) < 0.02
