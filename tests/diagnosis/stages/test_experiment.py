"""The proposed experiment of a linear seat: what is proposed, by which figures, in which words."""

import dataclasses
import re

import numpy as np
import pytest

from seatsim.diagnosis.candidates import Candidate, list_candidates
from seatsim.diagnosis.design import candidate_experiments, experiment
from seatsim.diagnosis.design.candidate_experiments import list_candidate_experiments
from seatsim.diagnosis.design.experiment import propose_experiment
from seatsim.effects.sensor import Gain

from ..builders import refit
from .toy import SKIP, Added, offer, place, pose, record, slow_floor, weigh_stated

NOISE = 0.05


def make_objective(folder, truth):
    runs = {"first": slow_floor(SKIP + 200), "second": slow_floor(SKIP + 240, 4)}
    return weigh_stated(pose(record(folder, truth, runs, noise=NOISE), nuisances=1))


def fit_members(objective, *effects):
    """Return the objective, the rig with the first of some effects, linearised, and each effect's best fitted rig.

    An effect is a term, or the name of one of the library, in any of its forms.
    """
    members = {}
    for effect in effects:
        forms = [(each, *each.start) for each in list_candidates(objective.problem) if each.effect == effect]
        fitted = [refit(objective, place(objective.problem, term)) for term in forms or [effect]]
        best = min(fitted, key=lambda each: each.cost)
        members[best.parameters.terms[0].effect] = best
    return objective, objective.linearise_nuisances(next(iter(members.values()))), members


@pytest.fixture(scope="module")
def equivalent(folder):
    """A rig with an effect that another imitates wherever the floor is slow."""
    objective = make_objective(folder, (Added("fast", 2.0),))
    return fit_members(objective, (offer("x.fast", "fast"), 2.0), "damper.gas_spring")


def test_the_cheapest_experiment_that_parts_the_members_is_proposed(equivalent):
    found = propose_experiment(*equivalent)
    # A bump is slow as well; from 1 to 20 Hz the floor changes from row to row.
    assert (found.kind, found.name) == ("excitation", "sweep")
    assert found.likeness_now > 0.99 and found.likeness_then < found.likeness_now
    assert re.match(r"sweep the floor from [\d.]+ to [\d.]+ Hz at [\d.]+ m/s\^2: they then differ by ", found.reason)
    assert found.reason.endswith(f", likeness {found.likeness_then:.2f} instead of {found.likeness_now:.2f}")
    assert found.scenario["name"] == "experiment-sweep"


def test_an_optimised_excitation_parts_the_members_better_within_travel_and_current(equivalent, monkeypatch):
    objective, *fitted = equivalent
    usual = objective.settings

    def propose(trials=16, **changed):
        monkeypatch.setattr(candidate_experiments, "_TRIALS", trials)
        settings = usual._replace(design=usual.design._replace(**changed))
        problem = dataclasses.replace(objective.problem, settings=settings)
        return propose_experiment(dataclasses.replace(objective, problem=problem), *fitted)

    # What the menu alone does not tell apart by enough is told apart by an excitation that is optimised.
    plain, found = propose(trials=1, unlike=0.0), propose(unlike=0.0)
    assert plain.kind == found.kind == "excitation" and found.likeness_then <= plain.likeness_then
    top = objective.problem.scenario.coil.max_current
    assert 0.0 < found.scenario["controller"]["current"] <= top
    # No floor that moves the suspension is within no travel: a change of the rig is proposed, or nothing.
    assert propose(largest_travel=1e-12).kind != "excitation"


def gain(channel, amount=0.1):
    term = Candidate("sensor.gain", Gain, {"channel": channel}, ("error",), (0.05,), (-0.9,), (10.0,))
    return term, amount


def test_a_wrong_sensor_is_told_from_another_driver_by_calibrating_it_and_the_others_are_parted_beside_that(folder):
    objective = make_objective(folder, (Gain("driver_acceleration", 0.2),))
    terms = gain("driver_acceleration"), "damper.gas_spring"
    found = propose_experiment(*fit_members(objective, *terms))
    assert (found.kind, found.name) == ("intervention", "calibrate_sensor")
    assert found.reason == "calibrating driver acceleration tells a wrong sensor from a change of the rig"
    assert 0.0 < found.likeness_now <= 1.0 and found.likeness_then == 0.0
    beside = propose_experiment(*fit_members(objective, *terms, "suspension.progressive_spring"))
    assert beside.reason.startswith(f"{found.reason}; beside that, ") and beside.kind in ("excitation", "none")


def test_the_reach_of_an_excitation_is_its_share_of_the_travel(equivalent):
    objective, nuisances, _ = equivalent
    problem, rig = objective.problem, nuisances.evaluation.parameters
    (sweep,) = [each for each in list_candidate_experiments(problem) if each.name == "sweep"]
    travel = experiment._respond(problem, sweep, rig)["suspension_displacement"]
    assert experiment._measure_reach(problem, sweep, rig) == pytest.approx(np.max(np.abs(travel)) / 0.05)
    plant = problem.scenario.plant._replace(travel=(-1e3, 0.02))
    stated = dataclasses.replace(problem, scenario=dataclasses.replace(problem.scenario, plant=plant))
    assert experiment._measure_reach(stated, sweep, rig) == pytest.approx(np.max(travel) / 0.02)
