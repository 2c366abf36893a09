"""A second search where parameters end at their bounds: when it is made, when it is stated, and what is said."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from seatsim.diagnosis import widen as module
from seatsim.diagnosis.diagnose import diagnose_problem
from seatsim.diagnosis.solution import Method, Solution
from seatsim.diagnosis.solve import solve
from seatsim.diagnosis.widen import find_at_bound, search_wider
from seatsim.effects.seat import Mass

from .toy import CHANNELS, Added, offer, place, pose, record, weigh_stated

RUNS = {"first": 300, "second": 360}
WITHOUT = ["driver.mass"]


def search(problem, said=None):
    first = solve(problem, WITHOUT, lambda _: None, Method())
    progress = (lambda _: None) if said is None else said.append
    return first, *search_wider(first, WITHOUT, progress, Method())


@pytest.fixture(scope="module")
def absorbed(folder):
    """A rig whose nominal mass is off by two and a half times its tolerance of 8 kg, and nothing else is wrong."""
    return pose(record(folder, (Mass(20.0),), RUNS, CHANNELS[:4], noise=0.02), 2)


def test_what_a_tolerance_forbids_is_found_by_a_second_search_and_said(absorbed):
    said = []
    first, second, notes = search(absorbed, said)
    assert first.decision.verdict != "none" and second.decision.verdict == "none"
    mass = second.objective.problem.parameters[0]
    assert mass.tolerance == pytest.approx(3.0 * 8.0)
    assert mass.at(second.decision.chosen.parameters.deviations[0]) == pytest.approx(100.0, abs=0.5)
    assert second.objective.problem.parameters[1] == absorbed.parameters[1]
    assert notes[0] == "at the bound of their tolerance: plant.driver_mass 80 (fitted 88)"
    assert notes[1].startswith("with 3 times the tolerance of these parameters ") and "is stated here" in notes[1]
    assert any("searching again with a wider tolerance" in text for text in said)


def test_a_diagnosis_notes_it(absorbed):
    found = diagnose_problem(absorbed, ["a note"], without=WITHOUT)
    assert found.verdict == "none" and found.notes[0] == "a note"
    assert found.notes[1].startswith("at the bound of their tolerance: plant.driver_mass 80")
    assert found.augmented["plant"]["driver_mass"] == pytest.approx(100.0, abs=0.5)
    # A file can hold floats of Python alone.
    assert {type(value) for value in found.augmented["plant"].values()} == {float}


def test_a_tolerance_that_is_right_is_kept(folder):
    first, second, notes = search(pose(record(folder, (Mass(4.0),), RUNS, CHANNELS[:4], noise=0.02), 2))
    assert second is first and notes == []


def test_what_no_parameter_can_take_is_left_to_the_first_search(folder):
    truth = (Mass(9.0), Added("three", 3.0))
    first, second, notes = search(pose(record(folder, truth, RUNS, CHANNELS[:4], noise=0.02), 2))
    assert second is first
    assert len(notes) in (0, 2) and all("the stated tolerance holds" in note for note in notes[1:])


def strain(problem, monkeypatch, settings):
    """Return what is said of two effects that explain everything beside three parameters at their bounds."""
    widening = problem.settings.widening._replace(**settings)
    eased = dataclasses.replace(problem, settings=problem.settings._replace(widening=widening))
    objective = weigh_stated(eased)
    one, mass = offer("x.one", "one"), offer("y.mass", "mass")
    both = objective.evaluate([place(eased, (one, 1.0), (mass, 0.05), deviations=[1.0, 0.0])])[0]
    chosen = SimpleNamespace(chosen=both, verdict="known")
    first = Solution(objective, SimpleNamespace(sets=((both,),)), chosen)
    alone = objective.evaluate([place(eased, (one, 1.0), deviations=[0.5, 0.0])])[0]
    monkeypatch.setattr(module, "solve", lambda *_: first._replace(decision=SimpleNamespace(chosen=alone)))
    return first, *search_wider(first, (), lambda _: None, Method())


@pytest.fixture
def two(folder):
    """A rig with one effect whose driver is heavier by one and a half times the tolerance."""
    return pose(record(folder, (Added("one", 1.0), Mass(12.0)), RUNS, CHANNELS[:4], noise=0.02), 2)


def test_fewer_effects_within_the_wider_tolerance_are_stated(two, monkeypatch):
    first, second, notes = strain(two, monkeypatch, {"strained": 1})
    assert first.decision.chosen.excess < 0.15
    assert second is not first and second.decision.chosen.parameters.names == {"x.one"}
    assert "fewer effects explain as much: this is stated here" in notes[1]


def test_one_parameter_at_its_bound_is_no_strain(two, monkeypatch):
    first, second, notes = strain(two, monkeypatch, {})
    assert second is first and len(notes) == 1


def test_effects_that_no_parameter_replaces_are_kept(two, monkeypatch):
    first, second, notes = strain(two, monkeypatch, {"strained": 1, "factor": 1.001})
    assert second is first and notes[1].endswith("all effects found are needed: the stated tolerance holds")


def test_a_parameter_at_its_bound_has_its_values_and_its_key(absorbed):
    rig = place(absorbed, deviations=[-1.0, 0.97])
    assert find_at_bound(absorbed, rig.add(offer("driver.mass", "mass"), np.ones(1))) == {}
    assert find_at_bound(absorbed, rig) == {0: "plant.driver_mass 80 (fitted 72)"}
    assert list(find_at_bound(absorbed, place(absorbed, deviations=[0.2, 0.985]))) == [1]
    assert find_at_bound(absorbed, place(absorbed, deviations=np.zeros(2))) == {}
