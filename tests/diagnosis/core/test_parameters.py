"""The parameters of a rig: which end at their bounds, and their natural sizes."""

import numpy as np
import pytest

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.objective import Parameters
from seatsim.effects.seat import EndStop
from seatsim.effects.sensor import Gain

from .toy import offer_two


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


@pytest.mark.parametrize("start, size", [(1.2, 1.2), (0.2, 0.8), (-0.2, 1.2)])
def test_the_size_of_an_effect_is_at_least_its_distance_from_where_it_is_off(start, size):
    gain = offer_two("suspension.one", (start, -0.5), (-8.0, 0.0), (2.0, 1.0))._replace(nominal=1.0)
    np.testing.assert_allclose(gain.scale, [size, 0.5])
