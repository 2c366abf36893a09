"""The search on one or several plants, its time, and what it says where it fails."""

import time

import numpy as np
import pytest

from controllers.synthesis.norm import hinf_norm
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.search import TimeBudget, search
from controllers.synthesis.solve import SEAT_TIME_BUDGET
from seatsim.schema.errors import SynthesisError

ONE, COLUMN = np.eye(1), np.zeros((2, 1))


def state_feedback(pole=-1.0, weight=1.0):
    """x' = pole x + w + u, z = (weight x, u), y = x."""
    return GeneralisedPlant(pole * ONE, ONE, ONE, [[weight], [0]], ONE, COLUMN, [[0], [1]], 0 * ONE)


def ask(plants, limit=1e3, seconds=SEAT_TIME_BUDGET, lines=None):
    lines = [] if lines is None else lines
    return search(plants, limit, 0, TimeBudget(time.monotonic(), seconds), lines.append)


def test_the_plant_in_the_middle_joins_where_it_is_worst():
    plants, lines = [state_feedback(-1.0), state_feedback(-1.0, 6.0), state_feedback(-1.2)], []
    gain = ask(plants, lines=lines)
    assert "plants 0, 2 of 3" in lines[0] and any("plants 0, 2, 1 of 3" in line for line in lines)
    norms = [hinf_norm(plant.close(gain)).value for plant in plants]
    scan = [max(hinf_norm(plant.close([[k]])).value for plant in plants) for k in -np.geomspace(1.0, 1000.0, 300)]
    assert max(norms) <= min(scan) * (1 + 1e-9)


def test_failure_tells_of_starts_limit_time_and_abscissa():
    # 1/s^3 needs phase lead: s^3 - k is never Hurwitz.
    A, B, C = 10.0 * np.eye(3, k=1), np.eye(3)[:, 2:], np.eye(3)[:1]
    plant = GeneralisedPlant(A, B, B, C, C, [[0]], [[0]], [[0]])
    words = r"no stabilising gain with \|gain\| <= 100 was found from \d+ starts in at most 1 s; .* is (\d\S*) 1/s"
    with pytest.raises(SynthesisError, match=words):
        ask([plant], 100.0, 1.0)
    with pytest.raises(SynthesisError, match="mode 2 1/s is not reached"):
        ask([state_feedback(), GeneralisedPlant(2 * ONE, ONE, 0 * ONE, ONE, ONE, 0 * ONE, 0 * ONE, 0 * ONE)])
