"""Statistics of sweeps against what is known exactly."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import qmc

from seatsim.report.sweep import advise_on_keys, tabulate_best
from seatsim.sweeps.parts import SweepRows, count_exceedances
from seatsim.sweeps.sensitivity import analyse_sensitivity, choose_key

COMFORT, HITS = "driver_acceleration_weighted", "end_stop_hits"


def rows_of(frame, keys, drawn=(), limits=None):
    frame = frame.assign(run=range(len(frame)), state="done", reason="", seed=0)
    metrics = [name for name in frame if name in (COMFORT, HITS)]
    manifest = {"limits": limits or {}, "counts": {"runs": len(frame)}, "identity": "0", "configuration": {}}
    return SweepRows(None, manifest, frame, frame, list(keys), list(drawn), metrics, dict.fromkeys(metrics, "-"))


@pytest.fixture(scope="module")
def known():
    """y = 3 a + b + 2 a b + 2 [t is B] of a, b uniform on [-1, 1] and t one of three: its indices are known."""
    u = 2 * qmc.LatinHypercube(3, seed=np.random.default_rng(1)).random(300) - 1
    text = np.array(list("ABC"))[np.random.default_rng(0).permutation(300) % 3]
    y = 3 * u[:, 0] + u[:, 1] + 2 * u[:, 0] * u[:, 1] + 2 * (text == "B")
    # A key may have any distribution: what counts is the rank of its values.
    return pd.DataFrame({"a": u[:, 0], "b": np.exp(u[:, 1]), "c": u[:, 2], "t": text, COMFORT: y})


def test_sobol_indices_are_the_exact_ones(known, conform):
    parts = {"a": 3.0, "b": 1 / 3, "ab": 4 / 9, "t": 4 * 2 / 9}
    whole = sum(parts.values())
    exact = {"a": (3.0, 3 + 4 / 9), "b": (1 / 3, 7 / 9), "c": (0, 0), "t": (8 / 9, 8 / 9)}
    found = analyse_sensitivity(rows_of(known, "abct", drawn="ab"))
    assert [row.key for row in found.rows] == ["a", "t", "b", "c"]
    for row in found.rows:
        for kind, index, part in zip(("first", "total"), (row.first, row.total), exact[row.key], strict=True):
            claim = f"Sobol index of {row.key} in 3 a + b + 2 a b + 2 [t is B], {kind}"
            conform(claim, "closed form", index, part / whole, tolerance=0.02)
        assert row.first_low <= row.first <= row.first_high and row.explained > 0.99
    best = choose_key(found.rows, rows_of(known, "abct", drawn="bc"))
    assert best.key == "b" and (best.at_low, best.at_high) == pytest.approx((-0.9 + 2 / 3, 0.9 + 2 / 3), abs=0.15)


def test_indices_are_refused_where_they_have_no_meaning(known):
    together = known.assign(b=known.a)
    assert "a and b vary together" in analyse_sensitivity(rows_of(together, "abc")).problem
    assert "too few for 4 keys" in analyse_sensitivity(rows_of(known.head(8), "abct")).problem
    constant = known.assign(**{COMFORT: 1.0})
    assert analyse_sensitivity(rows_of(constant, "abct")).problem == "no metric varies"


def test_shares_have_wilson_intervals(known, conform):
    frame = pd.DataFrame({"t": ["x"] * 50 + ["y"] * 50, COMFORT: [1.0] * 5 + [0.2] * 95, HITS: 0.0})
    found = count_exceedances(rows_of(frame, "t"))
    first = found[0]
    assert (first.group, first.metric, first.limit, first.exceeding, first.runs) == ({"t": "x"}, COMFORT, 0.5, 5, 50)
    for end, found_end, expected in (("low", first.low, 0.0435), ("high", first.high, 0.2136)):
        conform(f"95 % interval of a share of 5 of 50, {end} end", "Wilson 1927", found_end, expected, tolerance=1e-4)
    assert [row.exceeding for row in found[1:]] == [0, 0, 0]


def test_a_condition_is_never_advised_on_as_a_choice():
    levels = np.meshgrid([5.0, 10.0, 20.0], np.arange(1.0, 7.0), range(3))
    speed, damping = levels[0].ravel(), levels[1].ravel()
    comfort = 0.1 * speed + 0.1 * np.abs(damping - speed / 5.0)
    frame = pd.DataFrame({"excitation.speed": speed, "controller.damping": damping, COMFORT: comfort})
    for drawn in ((), ("excitation.speed", "controller.damping")):
        rows = rows_of(frame, ("excitation.speed", "controller.damping"), drawn)
        (choice,) = advise_on_keys(analyse_sensitivity(rows).of(COMFORT), rows)
        assert "controller.damping" in choice and "excitation.speed" not in choice
    (table,) = tabulate_best(rows_of(frame, ("excitation.speed", "controller.damping")))
    assert [row[:2] for row in table.rows] == [["20", "4"], ["10", "2"], ["5", "1"]]
    assert tabulate_best(rows) == []


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("runs", [8, 11, 16])
def test_a_value_of_a_single_run_is_predicted_from_no_other(runs):
    seen = set()
    for seed in range(20):
        rng = np.random.default_rng(seed)
        road = np.array(["B"] * (runs - 1) + ["C"])
        frame = pd.DataFrame({"a": rng.uniform(size=runs), "b": rng.uniform(size=runs), "t": road})
        frame[COMFORT] = frame.a + 0.1 * rng.standard_normal(runs)
        found = analyse_sensitivity(rows_of(frame, "abt"))
        seen.add(found.problem)
        assert all(np.isfinite(row.total) for row in found.rows)
    assert any("too few" in problem for problem in seen)
