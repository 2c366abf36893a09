"""Designs: which values are combined, drawn within their bounds, and refused before anything runs."""

import numpy as np
import pytest
from scipy import stats

import seatsim
from seatsim.schema.errors import list_sentences
from seatsim.sweeps.definition import read_definition
from seatsim.sweeps.execute import prepare
from seatsim.sweeps.plan import make_plan

from ..text import beside, parse

WIDE = {"plant": {}, "sweep": {f"effects.{k}.parameters.high": [0.1] * 100 for k in range(4)}}
MASS, STIFFNESS, CLASS = "plant.driver_mass", "plant.suspension_stiffness", "excitation.spectral_class"


def plan_of(path):
    return make_plan(read_definition(path))


def test_cross_combines_lists_and_ranges_and_draws_once_for_all_of_them(write_sweep):
    vary = {CLASS: ["EM1", "EM5"], MASS: {"normal": [80, 12]}, "temperature": {"from": 20, "to": 80, "steps": 3}}
    plan = plan_of(write_sweep(vary=vary, runs=4))
    rows = [plan.values(run) for run in range(plan.runs)]
    assert plan.runs == 24 and plan.keys == [CLASS, MASS, "temperature"]
    crossed = [(name, degrees) for name in ("EM1", "EM5") for degrees in (20, 50, 80)]
    assert [(row[CLASS], row["temperature"]) for row in rows[:6]] == crossed
    assert len({row[MASS] for row in rows}) == 4 and len({row[MASS] for row in rows[:6]}) == 1


def test_a_latin_hypercube_has_one_value_in_each_stratum(write_sweep):
    vary = {MASS: {"uniform": [50, 120]}, STIFFNESS: {"uniform": [4000, 5000]}}
    columns = plan_of(write_sweep(design="lhs", runs=50, vary=vary)).columns
    assert sorted(int(50 * (mass - 50) / 70) for mass in columns[MASS]) == list(range(50))
    assert abs(np.corrcoef(columns[MASS], columns[STIFFNESS])[0, 1]) < 0.4


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        ({"normal": [80, 12]}, stats.norm(80, 12)),
        ({"normal": [80, 12], "low": 70, "high": 120}, stats.truncnorm(-10 / 12, 40 / 12, 80, 12)),
        ({"lognormal": [4.3, 0.2]}, stats.lognorm(0.2, scale=np.exp(4.3))),
        ({"uniform": [50, 120]}, stats.uniform(50, 70)),
    ],
)  # fmt: skip
def test_draws_follow_their_distribution(stated, expected, write_sweep):
    columns = plan_of(write_sweep(design="lhs", runs=400, vary={MASS: stated})).columns
    assert stats.kstest(columns[MASS], expected.cdf).statistic < 0.01


def test_a_truncated_lognormal_and_a_choice_keep_to_what_is_stated(write_sweep):
    vary = {MASS: {"lognormal": [4.3, 0.5], "low": 60, "high": 100}, CLASS: {"choice": {"EM1": 0.2, "EM5": 0.8}}}
    columns = plan_of(write_sweep(design="sobol", runs=100, vary=vary)).columns
    assert min(columns[MASS]) >= 60 and max(columns[MASS]) <= 100
    assert columns[CLASS].count("EM5") == pytest.approx(80, abs=4)


def test_a_table_states_every_point(write_sweep, tmp_path):
    (tmp_path / "points.csv").write_text("plant.driver_mass,excitation.spectral_class\n55,EM1\n98.5,EM5\n")
    plan = prepare(write_sweep(design="table", table="points.csv", vary=None, runs=None)).plan
    assert [plan.values(run) for run in range(2)] == [{MASS: 55, CLASS: "EM1"}, {MASS: 98.5, CLASS: "EM5"}]


def test_a_run_is_the_scenario_with_its_values_and_a_replicate_the_next_seed(write_sweep, seat_file):
    path = write_sweep(vary={MASS: [55.0, 98.0], "effects.0.parameters.high": [0.03]}, replicates=2, runs=None)
    added = (
        "scenario:\n  effects: [{effect: suspension.end_stop, parameters: {low: -0.05, high: 0.05}}]\n"
        "  seed: 7\n  variants: {a: {}, b: {temperature: 50.0}}"
    )
    path.write_text(path.read_text().replace("scenario:", added))
    plan = prepare(path).plan
    found = [plan.scenario(run) for run in range(plan.runs)]
    assert [each.seed for each in found] == [7] * 4 + [8] * 4
    assert [each.plant.driver_mass for each in found[:4]] == [55.0, 55.0, 98.0, 98.0]
    assert [each.temperature for each in found[:2]] == [20.0, 50.0]
    assert {each.effects[0].high for each in found} == {0.03} and found[0].effects[0].low == -0.05
    assert plan.values(5) == {"variant": "b", MASS: 55.0, "effects.0.parameters.high": 0.03}


LONG = {"vary": {MASS: [60.0] * 1000, STIFFNESS: [4e3] * 1000}, "replicates": 10000}
TOO_MANY = [
    [{"scenario": WIDE}, ["makes 100000000 runs; a scenario has at most 10000"]],
    [LONG, ["makes 10000000000 runs (1000000 points x 10000 replicates)", "at most 10000000"]],
]
WRONG = [*parse(beside(__file__, "wrong_sweeps.yaml")), *TOO_MANY]


@pytest.mark.parametrize(("stated", "parts"), WRONG)
def test_what_is_wrong_is_refused_before_anything_runs(stated, parts, write_sweep, tmp_path):
    with pytest.raises(seatsim.InputError) as caught:
        prepare(write_sweep(**stated))
    assert all(part in str(caught.value) for part in parts), caught.value
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.yaml"]


def test_all_that_is_wrong_with_a_sweep_is_said(write_sweep):
    wrong = {"desing": 1, "seed": -1, "vary": {MASS: 80.0, STIFFNESS: []}, "limits": {"driver_vdw": 9.0}}
    with pytest.raises(seatsim.InputError) as caught:
        prepare(write_sweep(**wrong))
    said = "".join(list_sentences(caught.value))
    assert all(part in said for part in ("desing", "seed", MASS, STIFFNESS, "driver_vdw"))
