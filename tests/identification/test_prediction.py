"""Prediction of a record, figures of agreement, and what is held out."""

import math

import numpy as np
import pytest

from seatsim.identification.assessment import assess_agreement, assess_fit, mean_agreement
from seatsim.identification.problem import BenchModel, predict_force, prepare_inputs
from seatsim.identification.settings import IdentificationSettings as Settings
from seatsim.identification.settings import split_records
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import bench_force

from .benches import BOUC_WEN, made

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
