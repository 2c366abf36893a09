"""Weights of the score of a diagnosis, fitted to sealed cases: `python benchmarks/fit_score.py DIR:KEY ...`.

DIR holds the cases of a blind set or of `measured_carriers.py`, DIR.sealed their labels. The searches of each case,
without a random signal and beside one, and by the gap where the cause stays unknown, give its hypotheses, which are
kept in `DIR/CASE/hypotheses.json`: on the causes, and on what stands beside an unknown one, each with weights of its
own. With x the features of the hypotheses of a case and t those that are true, or the unknown cause where no fitted set
is, the weights w minimise

    sum over cases  (log sum exp(x w) - log sum over t exp(x_t w))  +  (RIDGE + HELD n) / 2 |(w - v) s|^2

(conditional logistic regression: McFadden 1974), s the standard deviations of the features and v the weights so far,
which hold what n other cases said: no case is to be given twice. Measured carriers say what stands beside an unknown
cause alone, since their nominals miss much else. A line for each kind of weights says how often the likeliest
hypothesis is the true one in cases left out, a fifth at a time, and how often effects of a probability from SURE on are
at work. The weights go into `seatsim/diagnosis/score.yaml`.
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
from seatsim.diagnosis.noise import differ_materially
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.solve import is_explained, pose_search, search_by_gap, search_causes
from seatsim.recordings.recording import load_recording
from seatsim.schema.arrays import Array
from seatsim.schema.files import write_json, write_text
from seatsim.schema.processes import run_jobs
from seatsim.schema.yaml_text import dump

RIDGE, HELD, SURE, PARTS, TINY = 5.0, 0.1, 0.9, 5, 1e-9
FEATURES = {
    "weight": list(score.WEIGHTS),
    "beside_unknown": ["gap", "prior", "parameters", "sensors", "unknown"],
}
"""Features that have a weight of each kind: of the causes, and of what stands beside an unknown one.

There the others gained nothing in cases left out.
"""
HYPOTHESES = "hypotheses.json"


class LabelledCase(NamedTuple):
    """The hypotheses on a case: their effects, their features, shape (hypotheses, features), and which are true."""

    names: list[set[str]]
    features: Array
    true: NDArray[np.bool_]


Labelled = list[LabelledCase]


def list_hypotheses(case: Path) -> None:
    """Write all hypotheses on a case that its diagnosis weighs, none where it shows no gap."""
    causes, beside_unknown = list[score.Hypothesis](), list[score.Hypothesis]()
    with ThreadPoolExecutor() as pool, threadpool_limits(1):
        problem = pose_problem(load_recording(case), pool)
        task, objective = pose_search(problem, (), lambda _: None, repeats=not differ_materially(problem))
        found, decided = search_causes(task, objective, ())
        if decided.decision.verdict != "none":
            if not is_explained(found, decided.decision):
                found, by_gap = search_by_gap(task, found)
                beside_unknown = score.list_hypotheses([by_gap], found.objective)
            causes = score.list_hypotheses(found.searches)
    listed = {"weight": causes, "beside_unknown": beside_unknown}
    content = {of: [{"names": sorted(h.names), "features": h.features} for h in each] for of, each in listed.items()}
    write_json(case / HYPOTHESES, content)


def label_case(hypotheses: list[dict[str, Any]], label: Label, kind: str) -> LabelledCase | None:
    """Return the hypotheses of a case, for weights of a kind, with the true ones; None where the case says nothing.

    The unknown cause alone, which has no name and is the last, is true of a rig without effects of the library, and the
    cause where no set of the rig's effects was fitted.
    """
    effects = set() if label["kind"] in ("outside", "untouched") else set(label["effects"])
    names = [set(each["names"]) for each in hypotheses]
    true = np.array([each == effects for each in names], dtype=bool)
    if kind == "weight" and label["kind"] in ("carried", "untouched"):
        return None
    if kind == "weight" and names and not np.any(true):
        true[-1] = True
    features = np.array([[each["features"].get(name, 0.0) for name in FEATURES[kind]] for each in hypotheses])
    return LabelledCase(names, features, true) if np.any(true) else None


def fit_weights(cases: Labelled, kind: str) -> Array:
    """Return the weights of the features of one kind."""
    # A feature that no case of this kind has keeps its weight.
    spread = np.std(np.concatenate([case.features for case in cases]), axis=0) + TINY
    scaled = [case.features / spread for case in cases]
    ridge = RIDGE + HELD * score.CASES[kind]
    before = np.array([getattr(score.WEIGHTS[name], kind) for name in FEATURES[kind]]) * spread

    def cost(weights: Array) -> tuple[float, Array]:
        change = weights - before
        value, slope = 0.5 * ridge * float(change @ change), ridge * change
        for case, features in zip(cases, scaled, strict=True):
            scores = features @ weights
            value += float(logsumexp(scores) - logsumexp(scores[case.true]))
            slope = slope + softmax(scores) @ features - softmax(scores[case.true]) @ features[case.true]
        return value, slope

    return np.asarray(minimize(cost, before, jac=True, method="L-BFGS-B").x / spread)


def cross_validate(cases: Labelled, kind: str) -> str:
    """Return a line on what the weights of the other cases say of each case."""
    right, sure = [], []
    for part in range(PARTS):
        weights = fit_weights([case for k, case in enumerate(cases) if k % PARTS != part], kind)
        for case in cases[part::PARTS]:
            probabilities = softmax(case.features @ weights)
            right.append(bool(case.true[np.argmax(probabilities)]))
            true = case.names[int(np.argmax(case.true))]
            for effect in set().union(*case.names):
                stated = sum(p for p, names in zip(probabilities, case.names, strict=True) if effect in names)
                sure += [effect in true] if stated >= SURE else []
    likeliest = f"{sum(right)} of {len(right)} likeliest true"
    return f"{kind}, left out: {likeliest}; effects from {SURE:g}: {sum(sure)} of {len(sure)}"


def main() -> None:
    """Fit the weights and write them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("sets", nargs="+", metavar="DIR:KEY")
    arguments = parser.parse_args()
    cases: dict[str, Labelled] = {kind: [] for kind in FEATURES}
    for folder, key in (each.rsplit(":", 1) for each in arguments.sets):
        base = Path(folder)
        labels = unseal(base.with_name(base.name + ".sealed"), key, base).labels
        missing = [(base / name,) for name in labels if not (base / name / HYPOTHESES).exists()]
        run_jobs(list_hypotheses, missing, PROCESSES, show_progress)
        found = {name: json.loads((base / name / HYPOTHESES).read_text()) for name in labels}
        for kind, labelled in cases.items():
            several = (label_case(found[name][kind], label, kind) for name, label in labels.items())
            labelled += [each for each in several if each]
    features = {name: each._asdict() for name, each in score.WEIGHTS.items()}
    for kind, names in FEATURES.items():
        print(cross_validate(cases[kind], kind))
        for name, weight in zip(names, fit_weights(cases[kind], kind).round(3).tolist(), strict=True):
            features[name][kind] = weight
    counts = {kind: before + len(cases[kind]) for kind, before in score.CASES.items()}
    write_text(score.FILE, dump({"cases": counts, "features": features}))


if __name__ == "__main__":
    main()
