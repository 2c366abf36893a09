"""What has no bounds is refused before anything is solved."""

import numpy as np
import pytest

import seatsim
from controllers.clairvoyant import clairvoyant
from seatsim.schema.errors import InputError


@pytest.fixture
def scenario(kept_seat_file):
    return seatsim.load(kept_seat_file, {"excitation.duration": 0.5})[0]


@pytest.mark.parametrize("weights", [[0.0], [-1.0], [np.inf], [], [[1.0]], 3.0])
def test_weights_are_one_or_more_numbers_above_zero(scenario, weights):
    with pytest.raises(InputError, match="numbers above 0"):
        clairvoyant(scenario, weights)


@pytest.mark.parametrize(("hold", "said"), [(0.0015, "choose 0.002 s"), (0.0004, "choose 0.001 s")])
def test_a_hold_is_a_multiple_of_the_step(scenario, hold, said):
    with pytest.raises(InputError, match=f"not a multiple of solver.step 0.001 s; {said}"):
        clairvoyant(scenario, [1.0], hold=hold)
    with pytest.raises(InputError, match="shorter than the time over which"):
        clairvoyant(scenario, [1.0], hold=0.501)
