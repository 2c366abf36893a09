"""Which ranges records hold, and what is told of tests beyond them."""

import math

import pytest

from seatsim.dampers.base import DAMPERS
from seatsim.identification.assessment import measure_coverage, note_limits
from seatsim.identification.damper_record import find_model

from .benches import made

PLAIN = DAMPERS.specification_of(find_model("bingham"))
SPEED = 2.0 * math.pi * 2.0 * 0.01


def test_ranges_of_a_sine():
    found = measure_coverage([made(seconds=4.0), made(current=0.5, seconds=4.0)])
    assert found.displacement == pytest.approx([-0.01, 0.01], rel=1e-3)
    assert found.velocity == pytest.approx([-SPEED, SPEED], rel=1e-3)
    assert found.current == [0.0, 0.5] and found.steady_currents == [0.0, 0.5] and found.temperature is None
    assert found.frequency == pytest.approx([2.0, 2.0], abs=0.26)


def test_the_lowest_and_the_highest_tone_of_a_record_are_covered():
    slow, middle, fast = (made(frequency=f, amplitude=0.01 / f, seconds=5.0) for f in (1.0, 3.0, 6.0))
    found = measure_coverage([slow._replace(velocity=slow.velocity + middle.velocity + fast.velocity)])
    assert found.frequency == pytest.approx([1.0, 6.0], abs=0.25)


@pytest.mark.parametrize("factor, told", [(1.04, False), (1.06, True)])
def test_tests_beyond_what_was_fitted_are_told_from_five_percent_on(factor, told):
    record = made()
    notes = note_limits(PLAIN, [record], [record._replace(velocity=factor * record.velocity)], 0.0)
    assert bool(notes) == told and all("of velocity" in note for note in notes)
    assert note_limits(PLAIN, [record], [], 0.0) == []


def test_a_model_that_wants_centred_strokes_is_told_of_others():
    wants = PLAIN._replace(centred=True)
    record = made()
    moved = record._replace(displacement=record.displacement + 0.02)
    assert note_limits(wants, [record], [], 0.0) == [] and note_limits(wants, [moved], [], 0.02) == []
    assert "middles of the strokes" in note_limits(wants, [moved], [], 0.0)[0]
