"""Weights of the score of a diagnosis, fitted to sealed cases: `python benchmarks/fit_score.py DIR:KEY ...`.

DIR holds the cases of a blind set, DIR.sealed their labels. The searches of each case, without a random signal and
beside one, and by the gap where the cause stays unknown, give its hypotheses, which are kept in
`DIR/CASE/hypotheses.json`. With x the features of the hypotheses of a case and t those that are true, or the unknown
cause where no fitted set is, the weights w minimise

    sum over cases  (log sum exp(x w) - log sum over t exp(x_t w))  +  RIDGE / 2 |(w - v) s|^2

(conditional logistic regression: McFadden 1974), s the standard deviations of the features and v the weights so far,
which hold what other cases said: no case is to be given twice. A table says how often the
likeliest hypothesis is the true one in cases left out, a fifth at a time, and how often effects of a probability from
SURE on are at work. The weights go into `seatsim/diagnosis/score.yaml`.
"""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from cases import PROCESSES, show_progress
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import logsumexp, softmax
from threadpoolctl import threadpool_limits

from seatsim.blind.sealed import Label, unseal
from seatsim.diagnosis import score
from seatsim.diagnosis.decide import decide_verdict
from seatsim.diagnosis.noise import differ_materially
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.solution import search
from seatsim.diagnosis.solve import adopt, pose_search, search_beside_disturbances, search_by_gap
from seatsim.recordings.recording import load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.files import write_json, write_text
from seatsim.schema.processes import run_jobs
from seatsim.schema.yaml_text import dump

RIDGE, SURE, PARTS = 5.0, 0.9, 5
HYPOTHESES = "hypotheses.json"
NAMES = list(score.WEIGHTS)


class LabelledCase(NamedTuple):
    """The hypotheses on a case: their effects, their features, shape (hypotheses, features), and which are true."""

    names: list[set[str]]
    features: Array
    true: NDArray[np.bool_]


def list_hypotheses(case: Path) -> None:
    """Write all hypotheses on a case that its diagnosis weighs, none where it shows no gap."""
    with ThreadPoolExecutor() as pool, threadpool_limits(1):
        problem = pose_problem(load_recording(case), pool)
        task, objective = pose_search(problem, (), lambda _: None, repeats=not differ_materially(problem))
        first, found = search(task, objective), list[score.Hypothesis]()
        if first.decision.verdict != "none":
            searches = [score.Search(objective, first.selection), *search_beside_disturbances(task, first)]
            if decide_verdict(searches, task.effects).verdict == "unknown":
                by_gap = search_by_gap(task, objective, first.selection)
                searches[0] = score.Search(objective, adopt(objective, first.selection, by_gap.selection))
            found = score.list_hypotheses(searches)
        write_json(case / HYPOTHESES, [{"names": sorted(each.names), "features": each.features} for each in found])


def label_case(hypotheses: list[dict[str, Any]], label: Label) -> LabelledCase:
    """Return the hypotheses of a case with the true ones; the unknown cause, which stands last, where none else is."""
    names = [set(each["names"]) for each in hypotheses]
    true = np.array([label["kind"] != "outside" and each == set(label["effects"]) for each in names])
    true[-1] = not true.any()
    features = np.array([[each["features"].get(name, 0.0) for name in NAMES] for each in hypotheses])
    return LabelledCase(names, features, true)


def fit_weights(cases: list[LabelledCase]) -> Array:
    """Return the weights of the features."""
    spread = np.std(np.concatenate([case.features for case in cases]), axis=0)
    scaled = [case.features / spread for case in cases]
    before = np.array([score.WEIGHTS[name].weight for name in NAMES]) * spread

    def cost(weights: Array) -> tuple[float, Array]:
        change = weights - before
        value, slope = 0.5 * RIDGE * float(change @ change), RIDGE * change
        for case, features in zip(cases, scaled, strict=True):
            scores = features @ weights
            value += float(logsumexp(scores) - logsumexp(scores[case.true]))
            slope = slope + softmax(scores) @ features - softmax(scores[case.true]) @ features[case.true]
        return value, slope

    return np.asarray(minimize(cost, before, jac=True, method="L-BFGS-B").x / spread)


def cross_validate(cases: list[LabelledCase]) -> str:
    """Return a line on what the weights of the other cases say of each case."""
    right, sure = [], []
    for part in range(PARTS):
        weights = fit_weights([case for k, case in enumerate(cases) if k % PARTS != part])
        for case in cases[part::PARTS]:
            probabilities = softmax(case.features @ weights)
            right.append(bool(case.true[np.argmax(probabilities)]))
            true = case.names[int(np.argmax(case.true))]
            for effect in set().union(*case.names):
                stated = sum(p for p, names in zip(probabilities, case.names, strict=True) if effect in names)
                sure += [effect in true] if stated >= SURE else []
    return f"left out: {sum(right)} of {len(right)} likeliest true; effects from {SURE:g}: {sum(sure)} of {len(sure)}"


def main() -> None:
    """Fit the weights and write them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("sets", nargs="+", metavar="DIR:KEY")
    arguments = parser.parse_args()
    cases = []
    for folder, key in (each.rsplit(":", 1) for each in arguments.sets):
        base = Path(folder)
        labels = unseal(base.with_name(base.name + ".sealed"), key, base).labels
        missing = [(base / name,) for name in labels if not (base / name / HYPOTHESES).exists()]
        run_jobs(list_hypotheses, missing, PROCESSES, show_progress)
        found = {name: json.loads((base / name / HYPOTHESES).read_text()) for name in labels}
        cases += [label_case(found[name], label) for name, label in labels.items() if found[name]]
    print(cross_validate(cases))
    weights = dict(zip(NAMES, fit_weights(cases).round(3).tolist(), strict=True))
    features = {name: {"weight": weights[name], "means": score.WEIGHTS[name].means} for name in NAMES}
    write_text(score.FILE, dump({"cases": score.CASES + len(cases), "features": features}))


if __name__ == "__main__":
    main()
