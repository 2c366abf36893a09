"""The comparison of two versions: what counts as a difference, and what is told only."""

import json
import math

import pandas as pd
import pytest

DIAGNOSIS = {
    "verdict": "known", "selected": ["coil.lag"], "where": [{"block": "coil", "share": 1.0}],
    "causes": [
        {"effect": "coil.lag", "parameters": {"time": {"std": 0.1}}}, {"effect": "coil.delay", "parameters": {}},
    ],
    "gap": {"shrink": 0.5, "before": {"overall": 0.2}},
}  # fmt: skip


@pytest.fixture(scope="module")
def module(benchmark):
    return benchmark("output_differences")


@pytest.fixture
def folders(tmp_path):
    """Two folders of equal outputs."""
    both = tmp_path / "old", tmp_path / "new"
    for folder in both:
        folder.mkdir()
        (folder / "diagnosis.json").write_text(json.dumps(DIAGNOSIS))
        (folder / "summary.json").write_text('{"runs": [{"metrics": {"a": {"value": 1.5}}, "warnings": []}]}')
        history(folder)
    return both


def history(folder, force=2.0):
    table = pd.DataFrame({"run": ["a", "a"], "time": [0.0, 1.0], "force": [math.nan, force]})
    table.to_parquet(folder / "history.parquet")


def changed(folder, old, new):
    path = folder / "diagnosis.json"
    path.write_text(path.read_text().replace(old, new))


@pytest.mark.parametrize(
    "old, new, relative",
    [
        (1.0, 1.0, 0.0), (2.0, 1.0, 0.5), (-1.0, 1.0, 2.0), (0.0, 0.0, 0.0), (0.0, 1e-300, 1.0),
        (math.nan, math.nan, 0.0), (math.nan, 1.0, math.inf), (math.inf, math.inf, 0.0), (math.inf, 1.0, math.inf),
        (1, 1.0, 0.0), (True, 1, math.inf),
        ("a", "a", 0.0), ("a", "b", math.inf), (None, None, 0.0), (None, 0.0, math.inf),
    ],
)  # fmt: skip
def test_relative_differences(module, old, new, relative):
    assert module.relative_difference(old, new) == relative


def test_equal_outputs_have_no_difference(module, folders):
    assert module.differences(*folders) == []


@pytest.mark.parametrize(
    "old, new, path, required",
    [
        ('"known"', '"none"', "verdict", True), ("0.5", "0.500000001", "gap.shrink", True),
        ('0.2', '0.3', "gap.before.overall", True), ('["coil.lag"]', '[]', "selected", True),
        ('"share": 1.0', '"share": 0.9', "where[0].share", True),
        ('"std": 0.1', '"std": 0.2', "causes[coil.lag].parameters.time.std", False),
    ],
)  # fmt: skip
def test_a_diagnosis_may_differ_in_its_causes_only(module, folders, old, new, path, required):
    changed(folders[1], old, new)
    found = {difference.path: difference.required for difference in module.differences(*folders)}
    assert found[path] == required and all(value == required for value in found.values())


def test_the_last_digits_and_the_order_of_causes_are_no_difference(module, folders):
    values = DIAGNOSIS | {"causes": DIAGNOSIS["causes"][::-1], "gap": DIAGNOSIS["gap"] | {"shrink": 0.5 + 1e-11}}
    (folders[1] / "diagnosis.json").write_text(json.dumps(values))
    assert module.differences(*folders) == []


def test_a_history_and_a_summary_agree_in_every_bit(module, folders):
    history(folders[1], math.nextafter(2.0, 3.0))
    (difference,) = module.differences(*folders)
    assert difference.path == "history.force[1]" and 0.0 < difference.relative < 1e-15
    history(folders[1])
    path = folders[1] / "summary.json"
    path.write_text(path.read_text().replace("1.5", "1.5000000000000002"))
    assert [d.path for d in module.differences(*folders)] == ["runs[0].metrics.a.value"]


def test_other_columns_rows_and_types_are_differences(module, folders):
    for table in ({"run": ["a"]}, {"run": ["a", "a"], "time": [0, 1], "force": [1.0, 2.0]}):
        pd.DataFrame(table).to_parquet(folders[1] / "history.parquet")
        assert module.differences(*folders)[0].relative == math.inf


def test_failures_agree_where_their_message_does(module, tmp_path):
    both = tmp_path / "old", tmp_path / "new"
    for folder in both:
        folder.mkdir()
        (folder / "failure.txt").write_text("exit status 2\nerror: bad input")
    assert module.differences(*both) == []
    (both[1] / "failure.txt").write_text("exit status 1\nerror: bad input")
    assert [d.path for d in module.differences(*both)] == ["failure.txt"]


def test_a_missing_output_is_a_difference(module, folders):
    (folders[1] / "diagnosis.json").unlink()
    (difference,) = module.differences(*folders)
    assert (difference.path, difference.old, difference.new) == ("diagnosis.json", "written", "missing")
    assert difference.required
