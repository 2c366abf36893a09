"""The vector of a rig's parameters: natural sizes, bounds, steps, and effects that come and go."""

import numpy as np
import pytest

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.objective import Parameters
from seatsim.effects.seat import EndStop
from seatsim.effects.sensor import Gain

from .toy import offer, offer_two

FIRST = offer_two("suspension.one", (-4.0, 0.5), (-8.0, 0.0), (2.0, 1.0))
SECOND = offer("coil.two", start=0.02, low=0.0, high=0.1)


@pytest.fixture
def rig():
    return Parameters(np.array([0.5, -1.0])).add(FIRST, np.array([-2.0, 0.25])).add(SECOND, np.array([0.03]))


def test_moving_to_a_vector_undoes_the_natural_sizes(rig):
    target = np.array([-0.25, 0.75, -1.5, 1.75, 4.0])
    moved = rig.move_to(target)
    np.testing.assert_allclose(moved.vector, target)
    np.testing.assert_allclose(moved.deviations, [-0.25, 0.75])
    np.testing.assert_allclose(np.concatenate(moved.values), [-6.0, 0.875, 0.08])
    assert moved.terms == rig.terms
    # The rig moved from stays as it is.
    np.testing.assert_allclose(rig.vector, [0.5, -1.0, -0.5, 0.5, 1.5])


def test_what_ends_at_a_bound_is_found_unless_it_is_off_there():
    gain = Candidate("sensor.gain", Gain, {"channel": "damper_force"}, ("error",), (0.05,), (-0.5,), (1.0,))
    stop = Candidate(
        "suspension.end_stop",
        EndStop,
        {"power": 1.0},
        ("low", "high", "stiffness", "damping"),
        (-0.01, 0.01, 1e4, 0.5),
        (-1.0, 0.0, 5e3, 0.0),
        (0.0, 1.0, 1e6, 100.0),
    )
    bent = stop._replace(
        fixed={}, free=(*stop.free, "power"), start=(*stop.start, 1.0), low=(*stop.low, 1.0), high=(*stop.high, 3.0)
    )
    rig = Parameters(np.array([0.979, -0.98, 1.0])).add(gain, np.array([-0.4995]))
    rig = rig.add(bent, np.array([-0.01, 1e-4, 9e5, 0.0, 1.0]))
    # Two hundredths of a start are within the margin; a damping of 0 and a power of 1 are off, as a limit of 0 is not.
    expected = [False, True, True, True, False, True, False, False, False]
    assert rig.find_at_bound(0.0201).tolist() == expected


def test_effects_are_added_and_removed_with_their_values(rig):
    alone = rig.remove("suspension.one")
    assert alone.names == {"coil.two"}
    np.testing.assert_allclose(alone.values[0], [0.03])
    np.testing.assert_allclose(alone.deviations, [0.5, -1.0])
    assert rig.remove("suspension.one", "coil.two").terms == ()
    assert rig.remove("other").terms == rig.terms and len(rig.remove("other").values) == 2
    again = alone.add(FIRST, np.array([1.0, 1.0]))
    assert again.terms == (SECOND, FIRST)
    np.testing.assert_allclose(again.values[1], [1.0, 1.0])
    assert len(rig.terms) == 2


@pytest.mark.parametrize("component", range(5))
def test_a_shift_moves_one_component_by_the_step_and_down_where_no_room_is_above(rig, component):
    for place, signed in ((rig, 0.02), (rig.move_to(rig.limits[1]), -0.02)):
        moved, step = place.shift(component, 0.02)
        assert step == signed
        np.testing.assert_allclose(moved.vector - place.vector, signed * (np.arange(5) == component), atol=1e-12)


@pytest.mark.parametrize("start, size", [(1.2, 1.2), (0.2, 0.8), (-0.2, 1.2)])
def test_the_size_of_an_effect_is_at_least_its_distance_from_where_it_is_off(start, size):
    gain = FIRST._replace(start=(start, -0.5), nominal=1.0)
    np.testing.assert_allclose(gain.scale, [size, 0.5])
