"""From a scenario to its bounds: what is refused, the order of weights, and who starts from whom."""

import numpy as np
import pytest

import seatsim
from controllers.clairvoyant import clairvoyant, solve
from controllers.clairvoyant.bound import LowerBound
from controllers.clairvoyant.envelope import DamperEnvelope
from controllers.clairvoyant.problem import ClairvoyantRun
from controllers.clairvoyant.recursion import ForceBand
from seatsim.schema.errors import InputError
from seatsim.schema.registry import find

INNER, OUTER = ForceBand(250.0, 45.0, 600.0, 665.0), ForceBand(240.0, 40.0, 650.0, 700.0)


@pytest.fixture
def scripted(kept_seat_file, monkeypatch):
    """A scenario whose ends cost no time: runs and bounds that tell of what they were asked."""
    asked = []

    def run(problem, band, start=None):
        assert band == INNER
        # From the bound's law the run is better at small weights, from the weakest damper at large ones.
        better = 0.5 if (start is not None) == (problem.weight < 500.0) else 0.0
        cost = problem.weight * (2.0 - better)
        return ClairvoyantRun(cost, cost / 4, cost / 100, np.full(3, better), np.array([-0.3, 1.2, 0.0]), None)

    def bound(problem, band, size, start):
        assert band == OUTER
        asked.append((problem.weight, size, start))
        return LowerBound(problem.weight, problem.weight, np.zeros(3))

    monkeypatch.setattr(solve, "find_best_run", run)
    monkeypatch.setattr(solve, "find_lower_bound", bound)
    monkeypatch.setattr(solve, "fit_envelope", lambda damper, current, temperature: DamperEnvelope(OUTER, INNER))
    (scenario,) = seatsim.load(kept_seat_file, {"excitation.duration": 0.5})
    return scenario, asked


@pytest.mark.parametrize("weights", [[0.0], [-1.0], [np.inf], [], [[1.0]], 3.0])
def test_weights_are_one_or_more_numbers_above_zero(scripted, weights):
    with pytest.raises(InputError, match="numbers above 0"):
        clairvoyant(scripted[0], weights)


@pytest.mark.parametrize(("hold", "said"), [(0.0015, "choose 0.002 s"), (0.0004, "choose 0.001 s")])
def test_a_hold_is_a_multiple_of_the_step(scripted, hold, said):
    with pytest.raises(InputError, match=f"not a multiple of solver.step 0.001 s; {said}"):
        clairvoyant(scripted[0], [1.0], hold=hold)
    assert clairvoyant(scripted[0], [1.0], hold=0.01).step == pytest.approx(0.01)
    with pytest.raises(InputError, match="shorter than the time over which"):
        clairvoyant(scripted[0], [1.0], hold=0.501)


def test_a_seat_that_is_released_moves_without_a_floor(scripted, kept_seat_file):
    rest = {"excitation": {"kind": "rest", "duration": 0.5}}
    (still,) = seatsim.load(kept_seat_file, rest)
    with pytest.raises(InputError, match="nothing moves"):
        clairvoyant(still, [1.0])
    (released,) = seatsim.load(kept_seat_file, {**rest, "start": {"displacement": 0.02}})
    assert clairvoyant(released, [1.0]).step == pytest.approx(0.005)


def test_the_method_is_registered_and_takes_the_usual_weights(scripted):
    found = find("bracket", "clairvoyant").of(scripted[0], lambda text: None)
    np.testing.assert_array_equal(found.weights, solve.WEIGHTS)
    np.testing.assert_allclose(np.sqrt(solve.WEIGHTS)[[0, -1]], [12.0, 150.0])
