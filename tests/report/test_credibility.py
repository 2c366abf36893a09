"""The credibility card: evidence is of the result itself, and a level is the number of conditions that hold."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

import seatsim
from seatsim.provenance.statement import at_work
from seatsim.report.credibility.card import say_doubt, show_card
from seatsim.report.credibility.evidence import Evidence, collect_diagnosis, collect_gap, collect_runs
from seatsim.report.credibility.rules import FACTORS, REACH, find_level
from seatsim.scenario.loading import load
from seatsim.simulation.runs import run_one

from .diagnoses import with_every_run

DOCUMENT = Path(__file__).parents[2] / "docs" / "reports.md"
BEST = Evidence(
    "diagnosis",
    energy=1e-6, step=1e-5, compared=4, held_out=2, error=0.05, noise=0.02, inputs=3, dampers={"bouc_wen": "published"},
    parameters_known=True, intervals=["all"], parameter_intervals=True, answer_interval=True, budget=True, runs=200,
    varied=["a"], drawn=["a"], explained=0.9, limits=True,
)  # fmt: skip


def level(name, evidence):
    return find_level(next(factor for factor in FACTORS if factor.name == name), evidence)


@pytest.mark.parametrize(("name", "reached"), [
    ("verification", 3), ("validation", 4), ("input pedigree", 4), ("uncertainty", 4), ("robustness", 4),
])  # fmt: skip
def test_levels_rise_from_nothing_known_to_all_known(name, reached):
    assert level(name, Evidence("diagnosis")) == 0 and level(name, BEST) == reached


@pytest.mark.parametrize(("name", "change", "reached"), [
    ("verification", {"energy": None}, 3), ("verification", {"energy": 0.02}, 1), ("verification", {"step": 0.005}, 2),
    ("validation", {"held_out": 0}, 1), ("validation", {"error": 0.2}, 3), ("validation", {"error": 0.5}, 2),
    ("validation", {"held_out": 1}, 3), ("input pedigree", {"inputs": None}, 0),
    ("input pedigree", {"doubts": ["x"]}, 1),
    ("input pedigree", {"dampers": {"mine": "own"}}, 2), ("input pedigree", {"loose": ["c_a"]}, 3),
    ("uncertainty", {"answer_interval": False}, 2), ("robustness", {"explained": 0.5}, 2),
    ("robustness", {"runs": 64}, 3),
])  # fmt: skip
def test_a_condition_that_fails_ends_the_level(name, change, reached):
    assert level(name, BEST._replace(**change)) == reached


@pytest.mark.parametrize("kind", REACH)
def test_a_card_shows_what_its_kind_of_result_can_reach_and_no_more(kind):
    rows = show_card(REACH[kind]).blocks[1].rows
    assert rows and all(
        level.split("\u00a0of\u00a0")[0] == level[-1] and following == "–" for _, level, _, following in rows
    )
    assert say_doubt(REACH[kind]) == "" and say_doubt(Evidence(kind)).startswith("Least certain is the ")
    assert ("verification" in [row[0] for row in rows]) == (kind in ("runs", "sweep", "diagnosis"))


def test_evidence_of_a_run_is_measured_on_it_and_on_what_was_read():
    scenario = load("quickstart", {"excitation.duration": 2.0})[2]
    run = run_one(scenario)
    found = collect_runs([run])
    assert 0 < found.energy < 1e-3
    assert found.inputs is None and found.dampers == {"bouc_wen": "published"}
    with at_work("run", [], ["quickstart"]):
        load("quickstart")
        assert collect_runs([run]).inputs == 1
    doubted = collect_runs([replace(run, warnings=("a reason",))])
    assert doubted.doubts == ("a reason",) and level("input pedigree", doubted._replace(inputs=1)) == 1


def test_evidence_of_a_diagnosis_is_of_its_held_out_run():
    found = collect_diagnosis(with_every_run())
    assert found.held_out == 1 and found.error == with_every_run().gap.after.overall and found.answer_interval


@pytest.mark.parametrize(("stated", "reached"), [("0.02", 4), ("", 3), ("fitted", 3)])
def test_a_tolerance_that_nobody_stated_is_no_pedigree(stated, reached, sound, tmp_path):
    folder = shutil.copytree(sound, tmp_path / "recorded")
    lines = [each for each in (folder / "recording.yaml").read_text().splitlines() if "parameter_tolerance" not in each]
    (folder / "recording.yaml").write_text("\n".join([*lines, *([f"parameter_tolerance: {stated}"] * bool(stated))]))
    found = collect_gap(str(folder / "nominal.yaml"), folder, seatsim.gap(folder / "nominal.yaml", folder))
    assert level("input pedigree", found._replace(inputs=1, doubts=())) == reached
    # What was not fitted to such data is validated by all runs, with whatever tolerance.
    assert found.held_out == (0 if stated == "fitted" else found.compared)


def test_the_documentation_has_every_condition_word_for_word():
    lines = {line.split("|")[1].strip(): line for line in DOCUMENT.read_text().splitlines() if line.startswith("| ")}
    for factor in FACTORS:
        cells = [cell.strip() for cell in lines[factor.name].split("|")[2:-1]]
        assert cells == [condition.words for condition in factor.conditions] + [""] * (4 - len(factor.conditions))
