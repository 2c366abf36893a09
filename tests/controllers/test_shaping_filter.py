"""The shaping filter of a floor against the spectrum that its record has."""

import numpy as np
import pytest

from controllers.seat_plant import fit_shaping_filter
from controllers.synthesis.norm import frequency_response
from controllers.synthesis.plant import LinearSystem
from seatsim.excitations.iso7096 import Iso7096, acceleration_density
from seatsim.rig.control import FloorRecord
from seatsim.schema.errors import InputError


def test_white_noise_through_the_filter_has_unit_power_and_the_spectrum_of_the_floor():
    acceleration = Iso7096("EM2", 600.0).floor(0.001, 1).acceleration
    filtered = fit_shaping_filter(FloorRecord(0.001, acceleration)).as_system()
    assert np.linalg.eigvals(filtered.A).real.max() < 0
    frequency = np.arange(0.02, 20.0, 0.02)
    density = np.abs(frequency_response(LinearSystem(*filtered), 2 * np.pi * frequency)[:, 0, 0]) ** 2
    # The density is two-sided: what lies above zero is half of the power.
    assert 2 * np.trapezoid(density, frequency) == pytest.approx(1.0, rel=0.1)
    wanted = acceleration_density(frequency, "EM2") / np.mean(acceleration**2) / 2
    # A model of order 4 has no flanks as steep as those of the standard; where the power lies it has right.
    assert frequency[np.argmax(density)] == pytest.approx(frequency[np.argmax(wanted)], rel=0.15)
    for low, high in ((0.0, 1.5), (1.5, 3.0), (3.0, 20.0)):
        inside = (frequency > low) & (frequency < high)
        shares = [2 * np.trapezoid(each[inside], frequency[inside]) for each in (density, wanted)]
        assert shares[0] == pytest.approx(shares[1], abs=0.12)


def test_another_draw_of_a_minute_gives_the_same_filter():
    draws = [FloorRecord(0.001, Iso7096("EM1", 60.0).floor(0.001, seed).acceleration) for seed in (12, 24)]
    first, second = (fit_shaping_filter(draw).coefficients for draw in draws)
    assert first == pytest.approx(second, rel=0.05)


def test_a_floor_at_rest_has_no_spectrum():
    with pytest.raises(InputError, match="the floor rests, or its record is too short"):
        fit_shaping_filter(FloorRecord(0.001, np.zeros(60_000)))
