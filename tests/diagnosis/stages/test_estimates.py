"""What a diagnosis rests on: standard deviations, each effect's own shrink, and the signals behind the pictures."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.estimates import compare_comfort, estimate_causes, trace_motion
from seatsim.diagnosis.result import Trace
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.solution import Solution
from seatsim.diagnosis.uncertainty import estimate_standard_deviations

from ..builders import refit
from .toy import RATE, SKIP, Added, AddedTwice, add_taps, offer, place, pose, record, weigh_stated, whiten

PRIOR = 0.58
TWICE = Candidate(
    "b.twice", AddedTwice, {"channel": "damper_force"}, ("first", "second"), (0.5, -4.0), (-20.0,) * 2, (20.0,) * 2
)


HALF = (Added("one", 0.5),)


def pose_one(folder, truth=HALF):
    return weigh_stated(pose(record(folder, truth)))


def scatter(objective, causes):
    """Return the posterior standard deviations of nuisances and amounts of the causes, from their signals."""
    signals = [0.1 * whiten(objective, "mass"), 0.1 * whiten(objective, "stiffness")]
    signals += [whiten(objective, cause) for cause in causes]
    precision = np.diag([PRIOR**-2, PRIOR**-2] + [0.0] * len(causes))
    covariance = np.linalg.inv(np.array(signals) @ np.array(signals).T + precision)
    return np.sqrt(np.diag(covariance))


def test_an_error_of_the_form_that_shows_in_one_band_widens_what_that_band_says(folder):
    """An error that is coherent with the signal does not average out as runs grow longer, as noise does."""
    ratios = []
    for rows in (400, 1600):
        runs = {"first": rows, "second": rows}
        objective = weigh_stated(pose(record(folder, (Added("one", 0.5), Added("three", 0.2)), runs, noise=0.01)))
        rig = objective.evaluate([place(objective.problem, (offer("a", "one"), 0.5))])[0]
        found = estimate_standard_deviations(objective, rig, objective.linearise_nuisances(rig))
        ratios.append(found[2] / scatter(objective, ["one"])[2])
    assert ratios[0] > 3.0 and ratios[1] == pytest.approx(2.0 * ratios[0], rel=0.4)


def test_they_are_the_spread_of_fits_to_other_noise(folder):
    objective = pose_one(folder)
    problem, rng, fits, stated = objective.problem, np.random.default_rng(5), [], []
    term = offer("a", "one", start=0.25)
    true = {run: problem.simulated(run, problem.nominal, (Added("one", 0.5),)) for run in problem.runs}
    for _ in range(150):
        drawn = {run: v + problem.noise[:, None] * rng.standard_normal(v.shape) for run, v in true.items()}
        other = dataclasses.replace(objective, problem=dataclasses.replace(problem, measured=drawn))
        fits.append(refit(other, place(problem, (term, 0.4))))
        if len(fits) <= 8:
            stated.append(estimate_standard_deviations(other, fits[-1], other.linearise_nuisances(fits[-1])))
    found = np.mean(stated, axis=0)
    spread = np.std([each.parameters.vector for each in fits], axis=0)
    # The data outweigh the prior, which would draw the fits together.
    assert np.all(found[:2] < 0.3 * PRIOR)
    assert np.all(found > 0.9 * spread) and np.all(found < 1.4 * spread)
    assert np.mean([each.parameters.values[0] for each in fits]) == pytest.approx(0.5, abs=0.25 * found[2])


def rms_gap(problem, run, amounts):
    """Return the gap of `measured - nominal - sum amounts` over the channels of a run, in standard deviations."""
    table = problem.recording.table(run)
    floor = table["floor_acceleration"]
    simulated = add_taps("floor", floor) + sum(a * add_taps(c, floor) for c, a in amounts.items())
    pairs = [(table[name][SKIP:], simulated[k, SKIP:]) for k, name in enumerate(problem.channels)]
    return np.sqrt(np.mean([np.mean((measured - own) ** 2) / np.var(measured) for measured, own in pairs]))


def test_an_effect_shrinks_the_calibrated_gap_of_the_held_out_run(folder):
    # Two effects are at work, of four that may be; one of them is chosen.
    objective = pose_one(folder, (Added("one", 0.5), Added("two", 0.2)))
    problem = objective.problem
    one = offer("a.one", "one", start=0.25)
    rigs = {"calibrated": place(problem, deviations=[0.1, 0.2]), "twice": place(problem, (TWICE, 0.5, 0.2))}
    rigs |= {"single": place(problem, (one, 0.4), deviations=[0.1, 0.0])}
    rigs |= {"augmented": place(problem, (one, 0.45), deviations=[0.0, 0.05])}
    rigs = {name: objective.evaluate([rig])[0] for name, rig in rigs.items()}
    kept = [rigs[name].parameters for name in ("calibrated", "augmented")]
    calibrated, augmented = objective.on_runs(["first"]).evaluate(kept)
    nuisances = objective.linearise_nuisances(rigs["calibrated"])
    selection = Selection(rigs["calibrated"], ((rigs["calibrated"],), (rigs["single"], rigs["twice"])), nuisances)
    probabilities = {"c.absent": 0.1, "b.twice": 0.1, "a.one": 0.9, "d.absent": 0.2}
    decision = Decision("known", rigs["single"], [], probabilities, 0.0, 0.0)
    solution, found = Solution(objective, selection, decision), objective.linearise_nuisances(augmented)
    shrink = {cause.effect: cause.shrink for cause in estimate_causes(solution, calibrated, found, "second")}
    base = rms_gap(problem, "second", {"mass": 0.01, "stiffness": 0.02})
    left = {"a.one": {"one": 0.4, "mass": 0.01}, "b.twice": {"one": 0.5, "two": 0.2}}
    for effect, amounts in left.items():
        assert shrink[effect] == pytest.approx(1.0 - rms_gap(problem, "second", amounts) / base)
    assert shrink["c.absent"] == shrink["d.absent"] == 0.0


def test_a_parameter_at_the_end_of_its_range_and_a_cause_all_of_whose_size_is_there_are_flagged(folder):
    objective = pose_one(folder)
    problem, term = objective.problem, offer("c.three", "three", start=0.25, high=0.1)
    half = TWICE._replace(high=(TWICE.high[0], 0.3))
    chosen = objective.evaluate([place(problem, (half, 0.5, 0.3), (term, 0.1))])[0]
    calibrated = objective.evaluate([place(problem)])[0]
    decision = Decision("known", chosen, [], {"b.twice": 0.9, "c.three": 0.8}, 0.0, 0.0)
    selection = Selection(calibrated, ((calibrated,),), objective.linearise_nuisances(calibrated))
    found = objective.linearise_nuisances(chosen)
    twice, third = estimate_causes(Solution(objective, selection, decision), calibrated, found, "first")
    ends = [[name for name, of in cause.parameters.items() if getattr(of, "at_bound", 0)] for cause in (twice, third)]
    assert (ends, twice.at_bound, third.at_bound) == ([["second"], ["amount"]], False, True)
    assert third.parameters["amount"].bound == (-20.0, 0.1)


def with_table(problem, **table):
    rows = {name: np.asarray(values) for name, values in table.items()}
    return dataclasses.replace(problem, recording=dataclasses.replace(problem.recording, tables={"first": rows}))


def test_motion_is_that_of_the_held_out_run_with_the_slope_of_its_travel(folder):
    problem = pose(record(folder, runs={"first": 240}))
    rows = np.arange(SKIP + 240.0)
    wave = 0.01 * rows / RATE + np.where(rows % 5 == 0, 1e-3, 0.0)
    table = {"coil_current": 2.0 * rows, "damper_temperature": 3.0 * rows, "floor_acceleration": rows}
    found = trace_motion(with_table(problem, **table, suspension_displacement=wave), "first")
    assert list(found) == ["coil_current", "damper_temperature", "displacement", "velocity"]
    assert np.array_equal(found["coil_current"], 2.0 * rows[SKIP:])
    assert np.array_equal(found["displacement"], wave[SKIP:])
    # A peak in every fifth row is gone in an average over five.
    assert found["velocity"][10:-10] == pytest.approx(0.01)
    bench = trace_motion(with_table(problem, displacement=wave, velocity=rows), "first")
    assert list(bench) == ["displacement", "velocity"] and bench["velocity"][50] == pytest.approx(0.01)
    assert list(trace_motion(with_table(problem, coil_current=rows), "first")) == ["coil_current"]


def test_comfort_is_the_rms_of_the_quoted_channels(folder):
    def trace(channel, unit):
        return Trace("a", channel, unit, 0.0, *(np.array(pair) for pair in ((0, 1), (3, 5), (1, 7), (9, 9), (2, 4))))

    known = [("damper_force", "N"), ("suspension_displacement", "m"), ("driver_acceleration", "m/s^2")]
    found = compare_comfort([trace(*each) for each in known])
    quoted = [("RMS driver acceleration", "m/s^2"), ("RMS suspension displacement", "m")]
    assert [(f.quantity, f.unit) for f in found] == quoted
    for figure in found:
        assert (figure.measured, figure.nominal, figure.after) == pytest.approx(np.sqrt([17.0, 25.0, 10.0]))
