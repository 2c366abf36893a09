"""Prediction of a record, figures of agreement, and records that were smoothed."""

import math

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import BoucWen
from seatsim.identification.figures import averaged, figures
from seatsim.identification.judging import Further, foretold, further, judge
from seatsim.identification.predict import Bench, drive, predicted
from seatsim.identification.smoothing import sharpened, smoothed
from seatsim.identification.split import Request, split
from seatsim.kernel.coil_current import simulate_current
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.coil import Coil, relax
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import bench_force

from .benches import BINGHAM, BOUC_WEN, made, write

PLAIN = TemperatureFactors()


def test_the_figures_of_hand_computed_numbers():
    measured, predicted = np.array([100.0, -100.0, 2.0, -2.0]), np.array([90.0, -100.0, 5.0, -2.0])
    found = figures(measured, predicted)
    # sum of squares 109 against 20008; |y| above 5 % of 100 in the first two rows: 0.1 and 0
    assert found.r2 == pytest.approx(1.0 - 109.0 / 20008.0)
    assert found.md == pytest.approx(0.05)
    assert found.rmse == pytest.approx(math.sqrt(109.0 / 4.0))
    assert found.fit_percent == pytest.approx(100.0 * (1.0 - math.sqrt(109.0 / 20008.0)))
    perfect = figures(measured, measured)
    assert perfect == (1.0, 0.0, 0.0, 100.0)
    assert averaged([found, perfect]).rmse == pytest.approx(found.rmse / 2.0)
    assert figures(measured, np.zeros(4)).fit_percent == pytest.approx(0.0)


def test_a_force_without_spread_has_no_fit():
    found = figures(np.full(3, 5.0), np.full(3, 4.0))
    assert found.r2 == found.fit_percent == -math.inf and found.rmse == 1.0


def test_a_prediction_is_the_force_of_the_bench_on_the_same_motion():
    record = made(BOUC_WEN, current=0.5, rate=1000.0)
    rows = drive(record, 0.0, False)
    assert rows.step == 0.002 and np.array_equal(rows.force, record.force[::2])
    force = bench_force(BOUC_WEN, record.displacement, record.velocity, 0.5, 20.0, 0.002, PLAIN)
    np.testing.assert_allclose(predicted(Bench(BOUC_WEN, PLAIN), rows), force, rtol=1e-12)
    every = predicted(Bench(BOUC_WEN, PLAIN), drive(record, 0.0, True))
    assert len(every) == len(record.force)
    np.testing.assert_allclose(every, record.force, atol=1e-3 * np.max(record.force))


def test_an_even_number_of_rows_loses_the_last_where_every_second_is_a_step():
    record = made(rate=1000.0)
    rows = drive(record.part(0, 1000), 0.0, False)
    assert len(rows.x) == 999 and len(rows.force) == 500 and rows.force[-1] == record.force[998]


def test_the_origin_of_the_displacement_is_taken_off():
    record = made(BOUC_WEN)
    moved = record._replace(displacement=record.displacement + 0.04)
    bench = Bench(BOUC_WEN, PLAIN)
    np.testing.assert_allclose(predicted(bench, drive(moved, 0.04, True)), predicted(bench, drive(record, 0.0, True)))


def test_a_command_drives_the_damper_through_the_coil():
    command, step = np.repeat([0.0, 1.0, 0.2], 40), 1e-3
    coil, now = Coil(rate=200.0, rate_fall=50.0), command[0]
    current = simulate_current(coil, command, step, now)
    for k, wanted in enumerate(command):
        assert current[k] == pytest.approx(now, abs=1e-12)
        now = relax(coil, now, wanted, step)
    record = made(current=lambda t: np.where(t % 1.0 < 0.5, 0.0, 1.0), coil=(200.0, 50.0))
    force = predicted(Bench(BINGHAM, PLAIN, 200.0, 50.0), drive(record, 0.0, True))
    np.testing.assert_allclose(force, record.force, atol=1e-9)


def test_temperature_scales_the_force_and_moves_the_offset():
    factors = TemperatureFactors(-0.004, 0.0, -0.007, 30.0)
    record = made(temperature=60.0, factors=factors, warming=0.5)
    force = predicted(Bench(BINGHAM, factors, warming=0.5), drive(record, 0.0, True))
    np.testing.assert_allclose(force, record.force, atol=1e-9)
    cold = predicted(Bench(BINGHAM, factors, warming=0.5), drive(record._replace(temperature=None), 0.0, True))
    assert np.mean(cold) == pytest.approx(30.0 - 0.5 * 10.0, abs=1.0), "a room has 20 degC"


def seconds(frequency, rate=500.0, long=8.0):
    """Return a record of so many seconds of a sine that begins and ends at rest."""
    t = np.arange(round(long * rate)) / rate
    size = np.interp(t, [0.0, 0.5, 2.5, long - 2.5, long - 0.5], [0.0, 0.0, 1.0, 1.0, 0.0])
    x = 0.01 * size * np.sin(2.0 * math.pi * frequency * t)
    v = np.gradient(x, 1.0 / rate)
    return BenchRecord("sine", "sine.csv", rate, x, v, 100.0 * v, 0.0 * x, False, None)


def test_sharpening_restores_what_an_average_took_away():
    record, rows = seconds(1.0), 151
    averaged_motion = smoothed(record.displacement, rows)
    assert np.max(averaged_motion[1000:3000]) < 0.9 * 0.01
    found = sharpened(record._replace(displacement=averaged_motion), rows)
    middle = slice(1000, 3000)
    np.testing.assert_allclose(found.displacement[middle], record.displacement[middle], atol=2e-4)
    np.testing.assert_allclose(found.velocity[middle], record.velocity[middle], atol=2e-3)
    assert np.array_equal(found.force, record.force)
    assert sharpened(record, 1) is record and smoothed(record.force, 1) is record.force


def test_sharpening_leaves_nothing_above_what_an_average_passes():
    record = seconds(3.2)
    assert np.max(np.abs(sharpened(record, 151).displacement[1000:3000])) < 1e-3


def test_further_records_are_judged_as_their_owner_treated_them(tmp_path):
    record = seconds(1.0)
    bench = Bench(BINGHAM, PLAIN)
    force = predicted(bench, drive(record, 0.0, True))
    kept = smoothed(force, 101) - np.mean(smoothed(force, 101))
    theirs = record._replace(displacement=smoothed(record.displacement, 101), force=kept)
    (found,) = foretold(bench, 0.0, Further([theirs], 101 / record.rate, True))
    assert found.part == "predicted" and found.figures.fit_percent > 97.0
    (plain,) = foretold(bench, 0.0, Further([theirs]))
    assert plain.figures.fit_percent < 90.0
    write([record], tmp_path / "more")
    assert further([tmp_path / "more"], 0.3, True).moving_average == 0.3


@pytest.mark.parametrize(
    "average, centred, named, problem",
    [
        (-0.3, False, True, "--moving-average -0.3 s is not permitted; it must be at least 0 s and shorter than"),
        (math.nan, False, True, "--moving-average nan s is not permitted"),
        (9.0, False, True, "shorter than the shortest record, 8 s"),
        (0.3, False, False, "name these by --predict"),
        (0.0, True, False, "name these by --predict"),
    ],
)
def test_what_cannot_be_predicted_is_refused(average, centred, named, problem, tmp_path):
    folder = write([seconds(1.0)], tmp_path / "more")
    with pytest.raises(InputError) as error:
        further([folder] if named else [], average, centred)
    assert problem in str(error.value)


def test_the_last_part_of_a_record_is_simulated_from_the_beginning():
    record = made(BOUC_WEN, current=0.5)
    held_out = made(BOUC_WEN, frequency=3.0, name="other")
    parts = split([record, held_out], Request(("other*",), 0.3))
    train, rest, other = judge(Bench(BOUC_WEN, PLAIN), parts, 0.0)
    assert [each.part for each in (train, rest, other)] == ["train", "test", "test"]
    assert len(train.predicted) + len(rest.predicted) == len(record.force)
    whole = predicted(Bench(BOUC_WEN, PLAIN), drive(record, 0.0, True))
    assert np.array_equal(np.append(train.predicted, rest.predicted), whole)
    assert np.array_equal(rest.record.force, record.force[len(train.predicted) :])
    assert rest.figures.fit_percent > 99.0 and other.figures.fit_percent > 99.0


def test_a_force_that_runs_away_counts_as_zero():
    wild = BoucWen(beta=-5e4, gamma=-5e4)
    parts = split([made(current=0.5)], Request())
    (found,) = judge(Bench(wild, PLAIN), parts, 0.0)
    assert not found.complete and math.isfinite(found.figures.rmse)


@pytest.mark.parametrize(
    "request_, problem",
    [
        (Request(("sine_9Hz",)), "--test sine_9Hz matches no record (did you mean 'sine_2Hz'?); there are sine_2Hz, x"),
        (Request(("*",)), "--test * holds out every record; leave some to fit to"),
        (Request(test_fraction=1.0), "--test-fraction 1 is not permitted; it must be at least 0 and below 1"),
        (Request(test_fraction=-0.1), "--test-fraction -0.1 is not permitted"),
        (Request(test_fraction=math.nan), "--test-fraction nan is not permitted"),
        (Request(test_fraction=0.999), "--test-fraction 0.999 cuts off 1 rows of 'sine_2Hz'; a part has at least 20"),
        (Request(test_fraction=0.001), "cuts off 1 rows of 'sine_2Hz'"),
    ],
)
def test_what_cannot_be_held_out_is_refused(request_, problem):
    with pytest.raises(InputError) as error:
        split([made(name="sine_2Hz"), made(name="x")], request_)
    assert problem in str(error.value)


@pytest.mark.parametrize("pattern", ["*2Hz*", "sine_2Hz", "sine_2Hz.csv", "sine_?Hz, 0 A"])
def test_a_pattern_matches_file_and_record(pattern):
    records = [made(name="sine_2Hz")._replace(name="sine_2Hz, 0 A"), made(name="x")]
    parts = split(records, Request((pattern, pattern)))
    assert [r.file for r in parts.held_out] == ["sine_2Hz.csv"] and [r.file for r in parts.train] == ["x.csv"]
