"""Prediction of a record, figures of agreement, and records that were smoothed."""

import math

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import BoucWen
from seatsim.identification.assessment import (
    PredictionData,
    assess_agreement,
    assess_fit,
    assess_predictions,
    load_prediction_data,
    mean_agreement,
)
from seatsim.identification.problem import BenchModel, predict_force, prepare_inputs, sharpen, smooth
from seatsim.identification.settings import IdentificationSettings as Settings
from seatsim.identification.settings import split_records
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import bench_force

from .benches import BINGHAM, BOUC_WEN, made, write

PLAIN = TemperatureFactors()


def test_the_figures_of_hand_computed_numbers():
    measured, predicted = np.array([100.0, -100.0, 2.0, -2.0]), np.array([90.0, -100.0, 5.0, -2.0])
    found = assess_agreement(measured, predicted)
    # sum of squares 109 against 20008; |y| above 5 % of 100 in the first two rows: 0.1 and 0
    assert found.r2 == pytest.approx(1.0 - 109.0 / 20008.0)
    assert found.md == pytest.approx(0.05)
    assert found.rmse == pytest.approx(math.sqrt(109.0 / 4.0))
    assert found.fit_percent == pytest.approx(100.0 * (1.0 - math.sqrt(109.0 / 20008.0)))
    perfect = assess_agreement(measured, measured)
    assert perfect == (1.0, 0.0, 0.0, 100.0)
    assert mean_agreement([found, perfect]).rmse == pytest.approx(found.rmse / 2.0)
    assert assess_agreement(measured, np.zeros(4)).fit_percent == pytest.approx(0.0)


def test_a_prediction_is_the_force_of_the_bench_on_the_same_motion():
    record = made(BOUC_WEN, current=0.5, rate=1000.0)
    rows = prepare_inputs(record, 0.0, False)
    assert rows.step == 0.002 and np.array_equal(rows.force, record.force[::2])
    force = bench_force(BOUC_WEN, record.displacement, record.velocity, 0.5, 20.0, 0.002, PLAIN)
    np.testing.assert_allclose(predict_force(BenchModel(BOUC_WEN, PLAIN), rows), force, rtol=1e-12)
    every = predict_force(BenchModel(BOUC_WEN, PLAIN), prepare_inputs(record, 0.0, True))
    assert len(every) == len(record.force)
    np.testing.assert_allclose(every, record.force, atol=1e-3 * np.max(record.force))


def seconds(frequency, rate=500.0, long=8.0):
    """Return a record of so many seconds of a sine that begins and ends at rest."""
    t = np.arange(round(long * rate)) / rate
    size = np.interp(t, [0.0, 0.5, 2.5, long - 2.5, long - 0.5], [0.0, 0.0, 1.0, 1.0, 0.0])
    x = 0.01 * size * np.sin(2.0 * math.pi * frequency * t)
    v = np.gradient(x, 1.0 / rate)
    return BenchRecord("sine", "sine.csv", rate, x, v, 100.0 * v, 0.0 * x, False, None)


def test_sharpening_restores_what_an_average_took_away():
    record, rows = seconds(1.0), 151
    averaged_motion = smooth(record.displacement, rows)
    assert np.max(averaged_motion[1000:3000]) < 0.9 * 0.01
    found = sharpen(record._replace(displacement=averaged_motion), rows)
    middle = slice(1000, 3000)
    np.testing.assert_allclose(found.displacement[middle], record.displacement[middle], atol=2e-4)
    np.testing.assert_allclose(found.velocity[middle], record.velocity[middle], atol=2e-3)
    assert np.array_equal(found.force, record.force)
    assert sharpen(record, 1) is record and smooth(record.force, 1) is record.force


def test_further_records_are_judged_as_their_owner_treated_them(tmp_path):
    record = seconds(1.0)
    bench = BenchModel(BINGHAM, PLAIN)
    force = predict_force(bench, prepare_inputs(record, 0.0, True))
    kept = smooth(force, 101) - np.mean(smooth(force, 101))
    theirs = record._replace(displacement=smooth(record.displacement, 101), force=kept)
    (found,) = assess_predictions(bench, 0.0, PredictionData([theirs], 101 / record.rate, True))
    assert found.part == "predicted" and found.agreement.fit_percent > 97.0
    (plain,) = assess_predictions(bench, 0.0, PredictionData([theirs]))
    assert plain.agreement.fit_percent < 90.0
    write([record], tmp_path / "more")
    assert load_prediction_data([tmp_path / "more"], 0.3, True).moving_average == 0.3


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
        load_prediction_data([folder] if named else [], average, centred)
    assert problem in str(error.value)


def test_the_last_part_of_a_record_is_simulated_from_the_beginning():
    record = made(BOUC_WEN, current=0.5)
    held_out = made(BOUC_WEN, frequency=3.0, name="other")
    parts = split_records([record, held_out], Settings(("other*",), 0.3))
    train, rest, other = assess_fit(BenchModel(BOUC_WEN, PLAIN), parts, 0.0)
    assert [each.part for each in (train, rest, other)] == ["train", "test", "test"]
    assert len(train.predicted) + len(rest.predicted) == len(record.force)
    whole = predict_force(BenchModel(BOUC_WEN, PLAIN), prepare_inputs(record, 0.0, True))
    assert np.array_equal(np.append(train.predicted, rest.predicted), whole)
    assert np.array_equal(rest.record.force, record.force[len(train.predicted) :])
    assert rest.agreement.fit_percent > 99.0 and other.agreement.fit_percent > 99.0


def test_a_force_that_runs_away_counts_as_zero():
    wild = BoucWen(beta=-5e4, gamma=-5e4)
    parts = split_records([made(current=0.5)], Settings())
    (found,) = assess_fit(BenchModel(wild, PLAIN), parts, 0.0)
    assert not found.complete and math.isfinite(found.agreement.rmse)


@pytest.mark.parametrize(
    "request_, problem",
    [
        (
            Settings(("sine_9Hz",)),
            "--test sine_9Hz matches no record (did you mean 'sine_2Hz'?); there are sine_2Hz, x",
        ),
        (Settings(("*",)), "--test * holds out every record; leave some to fit to"),
        (Settings(test_fraction=1.0), "--test-fraction 1 is not permitted; it must be at least 0 and below 1"),
        (Settings(test_fraction=-0.1), "--test-fraction -0.1 is not permitted"),
        (Settings(test_fraction=math.nan), "--test-fraction nan is not permitted"),
        (Settings(test_fraction=0.999), "--test-fraction 0.999 cuts off 1 rows of 'sine_2Hz'; a part has at least 20"),
        (Settings(test_fraction=0.001), "cuts off 1 rows of 'sine_2Hz'"),
    ],
)
def test_what_cannot_be_held_out_is_refused(request_, problem):
    with pytest.raises(InputError) as error:
        split_records([made(name="sine_2Hz"), made(name="x")], request_)
    assert problem in str(error.value)


@pytest.mark.parametrize("pattern", ["*2Hz*", "sine_2Hz", "sine_2Hz.csv", "sine_?Hz, 0 A"])
def test_a_pattern_matches_file_and_record(pattern):
    records = [made(name="sine_2Hz")._replace(name="sine_2Hz, 0 A"), made(name="x")]
    parts = split_records(records, Settings((pattern, pattern)))
    assert [r.file for r in parts.held_out] == ["sine_2Hz.csv"] and [r.file for r in parts.train] == ["x.csv"]
