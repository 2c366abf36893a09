"""Predictions of the screening against the exact minimum, which a linear rig has."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from seatsim.diagnosis.objective import Parameters
from seatsim.diagnosis.screen import measure_sensitivities, name_unstable, screen_candidates

from ..builders import refit
from .toy import Edge, Limited, Stated, add_up, draw_signals, make_problem, offer, offer_two, place, stack, weigh_stated

NAMES = ["nominal", "nuisance 0", "a.one", "a.one beside", "b.two", "c.three", "d.limit"]
INFINITE = float("inf")


def pose(amounts):
    signals = draw_signals(NAMES)
    # What is predicted from a part of the runs is exact only where that part is all.
    whole = weigh_stated(make_problem(signals, add_up(signals, amounts), nuisances=1))
    return whole.on_runs(whole.problem.runs[:2])


def screened(objective, candidates, base=(), bound=INFINITE, count=9):
    """Return the starts that the screening finds beside a fitted base of (candidate, values)."""
    calibrated = refit(objective, Parameters(objective.problem.nominal))
    nuisances = objective.linearise_nuisances(calibrated)
    offered = measure_sensitivities(objective, calibrated, candidates)
    fitted = refit(objective, place(objective.problem, *base))
    return screen_candidates(objective, fitted, offered, nuisances, bound, count)


def least_cost(objective, names, last=(-6.0, 6.0)):
    """Return the least cost with named signals, whose last amount has bounds, and that amount."""
    matrix, target = stack(objective, names)
    count = matrix.shape[1]
    low, high = np.full(count, -10.0), np.full(count, 10.0)
    low[0], high[0] = -1.0, 1.0
    low[-1], high[-1] = last
    best = lsq_linear(matrix, target, (low, high), method="bvls", tol=1e-14)
    return 2.0 * best.cost, best.x[-1]


def test_effects_that_cannot_be_simulated_are_named_with_the_number_of_their_starts():
    offered = [offer("b.two"), offer("c.three", cls=Edge), offer("c.three"), offer("c.three", cls=Edge)]
    said = name_unstable(offered, [offered[0], offered[2]])
    assert said == ("c.three could not be simulated from 2 of 3 starts, which were dropped",)
    assert name_unstable(offered[:1], offered[:1]) == ()


def shortlisted_below(objective, candidate, bound, base=()):
    return bool(screened(objective, [candidate], base, bound))


@pytest.mark.parametrize("start", [0.4, -0.7])
def test_the_predicted_cost_is_the_least_that_the_candidate_leaves(start):
    objective = pose({"b.two": 1.5, "c.three": 0.4, "nuisance 0": 0.6})
    exact, amount = least_cost(objective, ["b.two"])
    candidate = offer("b.two", start=start)
    assert shortlisted_below(objective, candidate, exact * (1.0 + 1e-5))
    assert not shortlisted_below(objective, candidate, exact * (1.0 - 1e-5))
    (found,) = screened(objective, [candidate])
    assert found.parameters.values[0][0] == pytest.approx(amount, rel=1e-4)


def test_a_candidate_without_a_sign_is_not_turned_around():
    objective = pose({"b.two": -1.5})
    none, _ = least_cost(objective, [], (-1.0, 1.0))
    one_sided = offer("b.two", start=0.5, low=0.0)
    assert shortlisted_below(objective, one_sided, none * (1.0 + 1e-5))
    assert not shortlisted_below(objective, one_sided, none * (1.0 - 1e-3))
    # The data do not show it at all: its own start is all that is left to try.
    (found,) = screened(objective, [one_sided])
    assert found.parameters.values[0][0] == 0.5
    (turned,) = screened(objective, [offer("b.two", start=0.5)])
    assert turned.parameters.values[0][0] == pytest.approx(-1.5, abs=0.05)


def test_a_fit_begins_at_a_candidates_own_start_where_the_prediction_fails():
    # Twice the amount at the start leaves nothing, were the rig linear; beyond 1 it leaves all bounds.
    objective = pose({"b.two": 1.2})
    (found,) = screened(objective, [offer("b.two", start=0.6, cls=Edge)])
    assert found.parameters.values[0][0] == 0.6 and np.isfinite(found.cost)


def test_a_structure_is_tried_once_from_the_start_that_is_predicted_best():
    # What a limit adds falls with it, so that no multiple of a start tells what another does.
    objective = pose({"d.limit": 1.5})
    starts = [offer("d.limit", start=start, low=0.0, high=1e3, cls=Limited) for start in (4.0, 0.5, 3.0)]
    (found,) = screened(objective, starts)
    assert found.parameters.values[0][0] == pytest.approx(0.5)


def test_each_size_is_predicted_by_itself():
    objective = pose({"a.one": 1.5, "a.one beside": -0.4})
    candidate = offer_two("a.one", (1.0, 0.25), (-3.0, -3.0), (3.0, 3.0))
    (together,) = screened(objective, [candidate])
    (apart,) = screened(objective, [candidate._replace(sizes=2)])
    np.testing.assert_allclose(apart.parameters.values[0], [1.5, -0.4], atol=0.05)
    assert apart.cost < 0.1 * together.cost


@pytest.mark.parametrize(
    ("start", "low", "high", "amount", "expected"),
    [(0.8, 0.0, 5.0, 0.5, 1.1), (0.4, 0.0, 5.0, -0.3, 0.3), (0.4, 0.2, 0.6, 0.5, 0.4)],
)
def test_an_effect_that_the_scenario_states_is_screened_from_what_it_states(start, low, high, amount, expected):
    # It is stated as 0.6, and what is measured asks for so much more; where it may only fall, it keeps its start.
    objective = pose({"b.two": amount})
    stated = offer("b.two", start=start, low=low, high=high, cls=Stated)._replace(nominal=0.6)
    (found,) = screened(objective, [stated])
    assert found.parameters.values[0][0] == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize("true, expected", [(1.28, 1.27), (1.17, 1.16), (1.07, 1.08), (0.85, 1 / 1.16), (1.0, 1.0)])
def test_a_limit_is_tried_a_little_to_the_side_that_the_prediction_points_to(true, expected):
    # What a limit adds falls with it: 2 - limit of the signal.
    objective = pose({"d.limit": 2.0 - true})
    (found,) = screened(objective, [offer("d.limit", start=1.0, low=0.0, high=1e3, cls=Limited)])
    assert found.parameters.terms[0].is_limit
    assert found.parameters.values[0][0] == pytest.approx(expected)


def test_candidates_are_screened_in_the_runs_that_leave_most_and_in_no_repeat_of_one():
    rows = {"long": 400, "short": 120, "again": 120, "other": 160}
    signals = draw_signals(NAMES, rows)
    # The long run leaves noise alone, of more power than the gap of a short one; the repeat as much as what it repeats.
    left = {"long": 0.0, "short": 0.3, "again": 0.3, "other": 0.2}
    measured = {run: add_up({run: signals[run]}, {"b.two": left[run]})[run] for run in rows}
    objective = weigh_stated(make_problem(signals, measured, repeats={"again": "short"}))
    (nominal,) = objective.evaluate([Parameters(objective.problem.nominal)])
    offered = measure_sensitivities(objective, nominal, [offer("b.two", start=0.4)])
    assert list(offered.changes) == ["short", "other"]
    (found,) = screen_candidates(objective, nominal, offered, objective.linearise_nuisances(nominal), INFINITE, 1)
    assert found.parameters.values[0][0] == pytest.approx(0.25, abs=0.06)
