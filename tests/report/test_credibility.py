"""The credibility card: evidence is of the result itself, and a level is the number of conditions that hold."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

import seatsim
from seatsim.dampers.base import DAMPERS
from seatsim.provenance.statement import at_work
from seatsim.recordings.header import NOT_STATED
from seatsim.report.credibility import read_conditions, trace_inputs, validate, verify
from seatsim.report.diagnosis import judge_diagnosis
from seatsim.report.gap import judge_gap
from seatsim.report.runs import judge_runs
from seatsim.scenario.loading import load

from .diagnoses import with_every_run
from .kinds import runs

DOCUMENT = Path(__file__).parents[2] / "docs" / "reports.md"
PUBLISHED = [DAMPERS.find("bouc_wen")]


def level_of(name, factors):
    return next(factor.level for factor in factors if factor.name == name)


@pytest.mark.parametrize(
    ("errors", "level"), [([], 0), ([float("nan")], 0), ([1e-6, 0.02], 1), ([1e-6, 0.005], 2), ([1e-6, 1e-5], 3)]
)
def test_numerical_errors_count_by_the_largest(errors, level):
    assert verify("{} is lost", errors).level == level


@pytest.mark.parametrize(
    ("compared", "held_out", "error", "noise", "level"),
    [(0, 0, None, None, 0), (4, 2, 0.05, 0.02, 4), (4, 0, 0.05, 0.02, 1), (4, 2, 0.2, 0.02, 3), (4, 2, 0.5, 0.02, 2),
     (4, 1, 0.05, 0.02, 3), (4, 2, 0.05, None, 4),
     # A recording that agrees better than its noise was made of the simulation.
     (4, 2, 0.05, 0.0, 2), (4, 2, 0.001, 0.02, 2)],
)  # fmt: skip
def test_a_condition_that_fails_ends_the_level(compared, held_out, error, noise, level):
    assert validate(compared, held_out, error, noise).level == level


@pytest.mark.parametrize(
    ("given", "level"),
    [({}, 4), ({"inputs": None}, 0), ({"doubts": ["x"]}, 1), ({"dampers": [DAMPERS.find("viscoelastic_plastic")]}, 2),
     ({"loose": ["c_a"]}, 3), ({"parameters_known": None}, 3), ({"parameters_known": False}, 3), ({"dampers": []}, 2),
     ({"dampers": [], "is_measured": True}, 4)],
)  # fmt: skip
def test_inputs_have_their_hashes_their_ranges_their_sources_and_their_tolerances(given, level):
    best = {"doubts": [], "dampers": PUBLISHED, "parameters_known": True, "inputs": 3}
    assert trace_inputs(**best | given).level == level


def test_evidence_of_a_run_is_measured_on_it_and_on_what_was_read():
    run = runs()[0]
    assert [level_of(name, judge_runs([run])) for name in ("verification", "input pedigree")] == [3, 0]
    with at_work("run", [], ["quickstart"]):
        load("quickstart")
        found = judge_runs([run])
        assert level_of("input pedigree", found) == 3 and "hashes of 1 input file kept" in found[1].evidence
        assert "bouc_wen: published" in found[1].evidence
        assert level_of("input pedigree", judge_runs([replace(run, warnings=("a reason",))])) == 1


def test_evidence_of_a_diagnosis_is_of_its_held_out_run():
    diagnosis = with_every_run()
    found = judge_diagnosis(diagnosis)
    for said in ("1 of 3 runs was kept out", f"{diagnosis.gap.after.overall:.1%}"[:3]):
        assert said in next(factor.evidence for factor in found if factor.name == "validation")
    assert level_of("uncertainty", found) >= 3
    # A tolerance that nobody stated makes less of a pedigree.
    assumed = judge_diagnosis(replace(diagnosis, notes=[*diagnosis.notes, f"{NOT_STATED}: 2 %"]))
    assert ["within a stated tolerance" in each[2].evidence for each in (found, assumed)] == [True, False]


@pytest.mark.parametrize(("stated", "reached"), [("0.02", 4), ("", 3), ("fitted", 3)])
def test_a_tolerance_that_nobody_stated_is_no_pedigree(stated, reached, sound, tmp_path):
    folder = shutil.copytree(sound, tmp_path / "recorded")
    lines = [each for each in (folder / "recording.yaml").read_text().splitlines() if "parameter_tolerance" not in each]
    (folder / "recording.yaml").write_text("\n".join([*lines, *([f"parameter_tolerance: {stated}"] * bool(stated))]))
    gap = replace(seatsim.gap(folder / "nominal.yaml", folder), notes=())
    with at_work("gap", [], []):
        found = judge_gap(str(folder / "nominal.yaml"), folder, gap)
    assert level_of("input pedigree", found) == reached
    # What was not fitted to such data is validated by all runs, with whatever tolerance.
    assert ("no run is known to be kept out" in found[0].evidence) == (stated == "fitted")


def test_the_documentation_has_every_condition_word_for_word():
    lines = {line.split("|")[1].strip(): line for line in DOCUMENT.read_text().splitlines() if line.startswith("| ")}
    for name, conditions in read_conditions().items():
        cells = [cell.strip() for cell in lines[name].split("|")[2:-1]]
        assert cells == [*conditions, *[""] * (4 - len(conditions))]
