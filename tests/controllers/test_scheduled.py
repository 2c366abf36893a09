"""The gain that follows the measured temperature."""

from types import SimpleNamespace

import numpy as np
import pytest

import seatsim
from controllers.laws.scheduled_output_feedback import ScheduledOutputFeedback
from controllers.seat_plant import Weights
from seatsim.rig.plant import Plant
from seatsim.schema.errors import InputError

SEAT = Plant(20.0, 80.0, 4600.0, 200.0, 60000.0, 1500.0)


@pytest.mark.parametrize(
    ("temperature", "k2"),
    [(0.0, 1000.0), (20.0, 1000.0), (35.0, 1500.0), (50.0, 2000.0), (99.0, 3000.0)],
)
def test_gain_is_interpolated_and_held(temperature, k2):
    law = ScheduledOutputFeedback((20.0, 50.0, 80.0), ((0.0, 1000.0), (30.0, 2000.0), (60.0, 3000.0))).prepared(SEAT)
    y = SimpleNamespace(temperature=temperature, displacement=0.0, velocity=1.0)
    assert law.wanted_force(y, ()) == pytest.approx(k2)
    y = SimpleNamespace(temperature=temperature, displacement=1.0, velocity=0.0)
    assert law.wanted_force(y, ()) == pytest.approx(0.03 * (k2 - 1000.0))


def test_synthesis_makes_up_for_a_weaker_damper():
    law = ScheduledOutputFeedback((20.0, 80.0), weights=Weights(30.0), force_factors=(1.0, 0.67))
    schedule = law.prepared(SEAT)
    np.testing.assert_allclose(np.array(schedule.k2)[1] * 0.67, schedule.k2[0], rtol=1e-3)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (ScheduledOutputFeedback((20.0, 80.0)), "exactly one"),
        (ScheduledOutputFeedback((80.0, 20.0), ((1.0, 1.0), (1.0, 1.0))), "must rise"),
        (ScheduledOutputFeedback((20.0, 80.0), ((1.0, 1.0),)), "gains has 1 entries"),
        (ScheduledOutputFeedback((20.0, 80.0), weights=Weights()), "force_factors has 0 entries"),
    ],
)
def test_wrong_schedules(law, words):
    with pytest.raises(InputError, match=words):
        law.prepared(SEAT)


def test_runs_as_the_law_whose_gain_it_has():
    base = {"excitation.duration": 2.0, "temperature": 50.0}
    plain = {"law": "static_output_feedback", "gain": [0.0, 2000.0]}
    gains = {"temperatures": [20.0, 80.0], "gains": [[0.0, 1000.0], [0.0, 3000.0]]}
    runs = [
        seatsim.run("h-infinity", {**base, "controller": {**law, "sample_time": 0.005}}).table
        for law in (plain, {"law": "scheduled_output_feedback", **gains})
    ]
    assert runs[1].driver_acceleration_rms[0] == pytest.approx(runs[0].driver_acceleration_rms[0], rel=1e-9)
