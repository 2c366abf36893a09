"""What is told of tests beyond the ranges that were fitted."""

import pytest

from seatsim.dampers.base import DAMPERS
from seatsim.identification.assessment import note_limits
from seatsim.identification.damper_record import find_model

from .benches import made

PLAIN = DAMPERS.specification_of(find_model("bingham"))


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
