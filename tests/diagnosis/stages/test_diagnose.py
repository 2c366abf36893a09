"""From a recording to its diagnosis: what is refused, what is passed on, and the whole way on a linear seat."""

import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from seatsim.diagnosis import diagnose as module
from seatsim.diagnosis.diagnose import diagnose, diagnose_problem
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.solution import Method
from seatsim.effects.seat import Mass
from seatsim.recordings.quality.examination import Examination
from seatsim.recordings.quality.issue import Issue
from seatsim.schema.errors import InputError

from .toy import CHANNELS, NOMINAL, SKIP, pose, record


class Posed(SimpleNamespace):
    """What stands for a problem; it notes the deadline that its fits are given."""

    settings = DiagnosisSettings()

    def until(self, deadline):
        return Posed(deadline=deadline)


class Solved(NamedTuple):
    """What stands for a solution."""

    objective: SimpleNamespace


def loaded(tolerance=0.02, **more):
    """Return what stands for a recording that states this tolerance."""
    return SimpleNamespace(header=SimpleNamespace(parameter_tolerance=tolerance), **more)


LOADED = loaded()
SOLUTION, STATED = Solved(SimpleNamespace(unhurried="unhurried")), Solved("unhurried")


@pytest.fixture
def stages(monkeypatch):
    """Write down what each stage is given; each returns a word."""
    seen = {}

    def stage(name, answer):
        def call(*given):
            seen[name] = given
            return answer

        monkeypatch.setattr(module, name, call)

    stage("load_recording", LOADED)
    stage("examine", Examination([Issue("warning", "kind", "mind the clock")]))
    stage("pose_problem", Posed())
    stage("check_nominal", None)
    stage("solve", SOLUTION)
    stage("search_wider", (SOLUTION, ["at the bound"]))
    stage("state_diagnosis", "diagnosis")
    return seen


def test_a_recording_is_examined_posed_solved_and_stated(folder, stages):
    said, recording, settings = [], record(folder), DiagnosisSettings()
    assert diagnose(recording, ["driver.mass"], said.append, settings) == "diagnosis"
    assert "load_recording" not in stages
    assert stages["examine"] == (recording,)
    posed, pool, given = stages["pose_problem"]
    assert posed is recording and given is settings and isinstance(pool, ThreadPoolExecutor)
    assert stages["check_nominal"] == (Posed(),)
    problem, without, tell, method = stages["solve"]
    assert without == ["driver.mass"] and method == Method()
    assert stages["search_wider"] == (SOLUTION, without, tell, method)
    # The search ends after 0.7 of the budget of 120 s.
    assert 80.0 < problem.deadline.end - time.monotonic() <= 84.0
    tell("searching")
    assert said == ["looking at the data", "searching"]
    assert stages["state_diagnosis"] == (STATED, ["mind the clock", "at the bound"], said.append, False)


def test_a_second_recording_is_joined_to_the_first(folder, stages, monkeypatch):
    monkeypatch.setattr(module, "join_recordings", lambda *both: (loaded(both=both), ["one channel is left out"]))
    first = record(folder)
    assert diagnose(first, after="elsewhere") == "diagnosis"
    assert stages["load_recording"] == ("elsewhere",)
    assert stages["examine"][0].both == stages["pose_problem"][0].both == (first, LOADED)
    assert stages["state_diagnosis"][1] == ["one channel is left out", "mind the clock", "at the bound"]


@pytest.mark.parametrize("given", ["somewhere", Path("somewhere")])
def test_a_recording_may_be_named_by_its_folder(stages, given):
    assert diagnose(given) == "diagnosis"
    assert stages["load_recording"] == (given,) and stages["examine"] == (LOADED,)
    assert stages["pose_problem"][0] is LOADED and stages["pose_problem"][2] is None
    assert stages["solve"][1] == () and stages["solve"][2]("any word") is None


def test_a_tolerance_that_is_assumed_is_said(stages, monkeypatch):
    monkeypatch.setattr(module, "load_recording", lambda _: loaded(None))
    diagnose("somewhere")
    assumed, *rest = stages["state_diagnosis"][1]
    assert assumed.startswith("parameter_tolerance is not stated") and "2 %" in assumed
    assert rest == ["mind the clock", "at the bound"]


@pytest.mark.parametrize("budget", [0.0, -1.0, float("nan")])
def test_a_budget_that_is_none_is_refused(budget):
    with pytest.raises(InputError, match=r"a budget of .* is not permitted; it must be above 0"):
        diagnose("somewhere", budget=budget)


def test_stages_that_the_budget_cut_short_are_named(stages, monkeypatch):
    def solve(problem, without, tell, method):
        tell("weighing the channels")
        tell("fitting sets of 1")
        while not problem.deadline.is_past:
            time.sleep(1e-3)
        tell("fitting sets of 2")
        return SOLUTION

    monkeypatch.setattr(module, "solve", solve)
    diagnose_problem(Posed(), ["a note"], budget=0.03)
    noted = stages["state_diagnosis"][1]
    assert noted[:2] == ["a note", "at the bound"] and len(noted) == 3
    assert noted[2].startswith("the budget of 0.03 s was spent, so that the answer is the best so far")
    assert noted[2].endswith("cut short: fitting sets of 1, fitting sets of 2")


def test_a_recording_with_an_error_is_refused_before_anything_is_fitted(folder, stages, monkeypatch):
    error = Issue("error", "kind", "the sensor is dead")
    monkeypatch.setattr(module, "examine", lambda recording: Examination([error, Issue("note", "x", "y")]))
    with pytest.raises(InputError, match=r"^the sensor is dead$"):
        diagnose(record(folder))
    assert "pose_problem" not in stages and "solve" not in stages


HEADER = """\
rig: seat
sample_rate: 200.0
nominal: nominal.yaml
runs: [{name: first, file: first.csv}]
channels: {floor_acceleration: {unit: m/s^2, noise_rms: 0.01}, driver_acceleration: {unit: m/s^2, noise_rms: 0.01}}
"""


def test_a_dead_sensor_is_such_an_error(tmp_path, monkeypatch):
    def pose_nothing(*given):
        raise AssertionError("a damaged recording was posed")

    monkeypatch.setattr(module, "pose_problem", pose_nothing)
    floor = np.random.default_rng(1).standard_normal(SKIP + 2200)
    (tmp_path / "nominal.yaml").write_text(NOMINAL)
    (tmp_path / "recording.yaml").write_text(HEADER)
    rows = [f"{k / 200.0},{value},0.0" for k, value in enumerate(floor)]
    (tmp_path / "first.csv").write_text("\n".join(["time,floor_acceleration,driver_acceleration", *rows]))
    with pytest.raises(InputError, match=r"first, driver_acceleration: is 0 throughout; the sensor is dead"):
        diagnose(tmp_path)


def test_a_method_and_notes_are_passed_on_and_algebra_keeps_to_one_thread(stages, monkeypatch):
    threads, other = [], Method(weigh_noise=None)

    def solve(*given):
        threads.extend(each["num_threads"] for each in threadpool_info())
        stages["solve"] = given
        return SOLUTION

    monkeypatch.setattr(module, "solve", solve)
    assert diagnose_problem(Posed(), ["a note"], ["x"], print, other) == "diagnosis"
    assert stages["solve"][1] == ["x"] and stages["solve"][3] is other
    assert not stages["solve"][0].deadline.is_past and stages["solve"][0].deadline.end == np.inf
    assert stages["state_diagnosis"] == (STATED, ["a note", "at the bound"], print, False)
    assert threads and set(threads) == {1}


@pytest.fixture(scope="module")
def heavier(folder):
    """A problem whose driver is heavier by far more than the tolerance."""
    recording = record(folder, (Mass(30.0),), {"first": 300, "second": 360, "third": 240}, CHANNELS[:4], noise=0.02)
    return pose(recording, 1)


def test_a_heavier_driver_is_found(heavier):
    said = []
    found = diagnose_problem(heavier, ["a note"], progress=said.append)
    assert (found.verdict, found.selected) == ("known", ["driver.mass"])
    assert [share.block for share in found.where] == ["driver"] and found.causes[0].effect == "driver.mass"
    # The tolerance of 8 kg takes its part, by its prior.
    change = found.causes[0].parameters["change"]
    moved = found.augmented["plant"]["driver_mass"] - 80.0
    assert change.unit == "kg" and change.value + moved == pytest.approx(30.0, abs=0.5)
    assert found.gap.after.overall < 0.1 * found.gap.before.overall
    assert found.gap.shrink_interval[0] > 0.6 and found.notes[0] == "a note"
    assert said[:3] == ["weighing the channels", "fitting sets of 1", "holding out a run"]
    assert found.probability_unknown < 0.1 and found.probability_none < 0.1


@pytest.mark.parametrize("budget", [1e-6, 1e-3])
def test_however_short_the_time_there_is_an_answer_that_says_what_was_cut(heavier, budget):
    found = diagnose_problem(heavier, budget=budget)
    assert any(note.startswith(f"the budget of {budget:g} s was spent") for note in found.notes)
    assert found.verdict in ("known", "ambiguous", "unknown") and found.augmented["plant"]


def test_a_search_without_time_knows_the_calibrated_rig_alone(heavier):
    found = diagnose_problem(heavier, budget=1e-6)
    assert (found.verdict, found.selected) == ("unknown", [])


def test_what_is_withheld_is_not_found(heavier):
    found = diagnose_problem(heavier, without=["driver.mass"])
    assert "driver.mass" not in {cause.effect for cause in found.causes}
    assert found.selected != ["driver.mass"]


def test_a_sound_rig_has_no_gap(folder):
    found = diagnose_problem(pose(record(folder, (), {"first": 300, "second": 360}, CHANNELS[:4]), 1))
    assert (found.verdict, found.selected, found.where) == ("none", [], [])
