"""Baselines of the diagnosis on a blind set: `python benchmarks/diagnosis_baselines.py DIR --sealed FILE --key KEY`.

Each is given the rig with its parameters refitted inside their tolerance, and writes `CASE/BASELINE/diagnosis.json`;
cases that have one are skipped. The table says how often each is right, beside `CASE/diagnosis` where that is there.
Thresholds of `correlation` and `bic` are those with the most right verdicts on the first 40 of 120 development cases
(11 none, 13 one effect, 7 two, 9 outside), a second effect beside a right single one counted as wrong; chosen once,
then frozen. Those of `sparse` were not tuned.

correlation  Cosine, by channel over all runs, of the residual with what each candidate at its start changes. The effect
    with the largest |cosine| is named from NAMED on. It is then projected out of each channel, and a second one is
    named from NAMED_NEXT on. Below NAMED: `unknown` where a channel is off, beyond its noise, by LARGE of its standard
    deviation, else `none`.
bic  Forward selection with seatsim's own candidates and fits, chi^2 from the stated noise as if it were white,
    BIC = N ln(chi^2 / N) + k ln N with N the numbers compared and k the free parameters of the effects, up to three
    effects while BIC falls, ranked by how much they move; `unknown` where chi^2 / N stays above MISFIT.
sparse  Sequentially thresholded least squares (the optimiser of SINDy, Brunton et al. 2016) of the residual, in noise
    units, on what each candidate at its start changes: columns whose share of the residual stays below SPARSE are
    dropped until none is. Effects are ranked by what their columns take off, at most two; `unknown` where more than
    LEFT of the residual's power beyond noise is left.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
from cases import (
    LEAST_NOISE,
    Diagnoser,
    EncodedDiagnosis,
    Ranked,
    diagnose_missing,
    encode_verdict,
    rank_by_figure,
    weigh_stated_noise,
)

from seatsim.blind.score.score import score_verdicts
from seatsim.blind.score.verdicts import Rate, read_verdict
from seatsim.blind.sealed import KINDS, Label, unseal
from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.fit import fit
from seatsim.diagnosis.movement import measure_movements
from seatsim.diagnosis.objective import Evaluation, Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, pose_problem
from seatsim.diagnosis.select import select_effects
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.recordings.recording import load_recording
from seatsim.schema.arrays import Array

NAMED, NAMED_NEXT, LARGE = 0.85, 0.8, 0.02
MISFIT = 8.0
SPARSE, LEFT, SWEEPS = 0.15, 0.5, 10
FULL = DiagnosisSettings()
TO_THE_END = FULL._replace(selection=FULL.selection._replace(worthwhile=np.inf, nothing_left=-1.0))
"""Settings under which every larger set is sought, so that BIC alone says how many effects there are."""


def calibrate(objective: Objective) -> Evaluation:
    """Return the nominal rig with its parameters refitted inside their tolerance."""
    evaluation = objective.evaluate([Parameters(objective.problem.nominal)])[0]
    for _ in range(2):
        evaluation = fit(objective, evaluation, objective.linearise_nuisances(evaluation))
    return evaluation


def diagnose_by_correlation(case: Path) -> EncodedDiagnosis:
    """Return the verdict by correlation."""
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(load_recording(case), pool)
        objective = Objective(problem, weigh_stated_noise(problem))
        off, first, second = correlate(objective, calibrate(objective))
    best, cosine = first[0]
    if cosine < NAMED:
        return encode_verdict(problem.recording, "unknown" if off > LARGE else "none", [], [best.partition(".")[0]])
    named = [best] + [effect for effect, other in second[:1] if other >= NAMED_NEXT]
    return encode_verdict(problem.recording, "known", named)


def list_changes(objective: Objective, calibrated: Evaluation) -> tuple[Array, list[tuple[str, Array]]]:
    """Return the residual of the calibrated rig and, by effect, what each candidate at its start changes in it.

    Each has the shape (channels, rows of all runs).
    """
    problem = objective.problem
    candidates = list_candidates(problem)
    starts = objective.evaluate([calibrated.parameters.add(c, np.array(c.start)) for c in candidates])
    residual = _pool_runs(calibrated, problem)
    changes = [(c.effect, residual - _pool_runs(start, problem)) for c, start in zip(candidates, starts, strict=True)]
    return residual, changes


def correlate(objective: Objective, calibrated: Evaluation) -> tuple[float, Ranked, Ranked]:
    """Return the largest gap of a channel beyond its noise, the effects by |cosine|, and again without the first."""
    problem, (residual, changes) = objective.problem, list_changes(objective, calibrated)
    power = np.mean(residual**2, axis=1) - problem.noise**2
    off = float(np.max(np.sqrt(power.clip(0.0)) / problem.spread))
    cosines = [(effect, _largest_cosine(residual, change, problem)) for effect, change in changes]
    best = max(range(len(cosines)), key=lambda k: cosines[k][1])
    first, change = changes[best]
    share = np.sum(residual * change, axis=1) / np.maximum(np.sum(change**2, axis=1), 1e-30)
    rest = residual - share[:, None] * change
    again = [(effect, _largest_cosine(rest, other, problem)) for effect, other in changes if effect != first]
    return off, rank_by_figure(cosines), rank_by_figure(again)


def _pool_runs(evaluation: Evaluation, problem: DiagnosisProblem) -> Array:
    return np.concatenate([evaluation.residuals[run] for run in problem.runs], axis=1)


def _largest_cosine(residual: Array, change: Array, problem: DiagnosisProblem) -> float:
    """Return the largest |cosine| of a channel, 0 where the change leaves the bounds or is no change."""
    size = np.linalg.norm(change, axis=1)
    seen = np.isfinite(size) & (size > 1e-6 * problem.spread * np.sqrt(change.shape[1]))
    if not np.any(seen):
        return 0.0
    product = np.abs(np.sum(residual[seen] * change[seen], axis=1))
    return float(np.max(product / (size[seen] * np.linalg.norm(residual[seen], axis=1))))


def diagnose_by_bic(case: Path) -> EncodedDiagnosis:
    """Return the verdict by BIC."""
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(load_recording(case), pool, TO_THE_END)
        chosen, misfit = select_by_bic(Objective(problem, weigh_stated_noise(problem)))
        sizes = [float(np.mean(move**2)) for move in measure_movements(problem, chosen)]
    ranked = rank_by_figure([(term.effect, size) for term, size in zip(chosen.parameters.terms, sizes, strict=True)])
    kind = "unknown" if misfit > MISFIT else "known" if ranked else "none"
    return encode_verdict(problem.recording, kind, [effect for effect, _ in ranked])


def select_by_bic(objective: Objective) -> tuple[Evaluation, float]:
    """Return the set from which BIC falls no more, and its chi^2 / N."""
    selection = select_effects(objective, list_candidates(objective.problem), lambda _: None)
    best = [sets[0] for sets in selection.sets]
    worth = [_evaluate_bic(evaluation) for evaluation in best]
    size = next((k for k in range(len(best) - 1) if worth[k + 1] >= worth[k]), len(best) - 1)
    return best[size], best[size].cost / best[size].rows


def _evaluate_bic(evaluation: Evaluation) -> float:
    """Return `N ln(chi^2 / N) + k ln N` with N the numbers compared and k the free parameters of the effects."""
    rows = evaluation.rows
    free = sum(len(term.free) for term in evaluation.parameters.terms)
    return float(rows * np.log(evaluation.cost / rows) + free * np.log(rows))


def diagnose_by_regression(case: Path) -> EncodedDiagnosis:
    """Return the verdict by sparse regression."""
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(load_recording(case), pool)
        objective = Objective(problem, weigh_stated_noise(problem))
        residual, changes = list_changes(objective, calibrate(objective))
    noise = np.maximum(problem.noise, LEAST_NOISE * problem.spread)[:, None]
    changes = [(effect, change) for effect, change in changes if np.all(np.isfinite(change))]
    ranked, left = regress_sparsely((residual / noise).ravel(), [(e, (c / noise).ravel()) for e, c in changes])
    power = float(np.mean((residual / noise) ** 2))
    if power < MISFIT:
        return encode_verdict(problem.recording, "none", [])
    named = [effect for effect, _ in ranked[:2]]
    return encode_verdict(problem.recording, "unknown" if left > LEFT * power or not named else "known", named)


def regress_sparsely(target: Array, columns: Sequence[tuple[str, Array]]) -> tuple[Ranked, float]:
    """Return the effects by the power that their columns take off the target, and the power that is left."""
    kept = [k for k, (_, column) in enumerate(columns) if float(column @ column) > 0.0]
    shares: Array = np.zeros(0)
    for _ in range(SWEEPS):
        matrix = np.column_stack([columns[k][1] for k in kept]) if kept else np.zeros((len(target), 0))
        shares = np.asarray(np.linalg.lstsq(matrix, target, rcond=None)[0])
        size = np.linalg.norm(matrix * shares, axis=0) / np.linalg.norm(target)
        if np.all(size >= SPARSE):
            break
        kept = [k for k, share in zip(kept, size, strict=True) if share >= SPARSE]
    worth = [(columns[k][0], float(np.mean((columns[k][1] * s) ** 2))) for k, s in zip(kept, shares, strict=True)]
    return rank_by_figure(worth), float(np.mean((target - matrix @ shares) ** 2))


BASELINES: dict[str, Diagnoser] = {
    "correlation": diagnose_by_correlation,
    "bic": diagnose_by_bic,
    "sparse": diagnose_by_regression,
}


def show_scores(base: Path, labels: Mapping[str, Label]) -> None:
    """Print how many verdicts of each method are right; a case without a verdict counts as wrong."""
    rows = {}
    for method in (*BASELINES, "diagnosis"):
        verdicts = {case: read_verdict(base / case / method / "diagnosis.json") for case in labels}
        if any(verdict.verdict != "missing" for verdict in verdicts.values()):
            score = score_verdicts(labels, verdicts)
            rates: dict[str, Rate] = {"right": score.right, "block first": score.block}
            rates |= {kind: score.kinds.get(kind, Rate(0, 0)) for kind in KINDS}
            rates["false alarms"] = score.false_alarms
            rows[method] = {name: f"{rate.right}/{rate.total}" for name, rate in rates.items()}
    print(f"baselines, {len(labels)} cases\n{pd.DataFrame.from_dict(rows, orient='index').to_string()}")


def main() -> None:
    """Diagnose what is not diagnosed yet, and print the table."""
    parser = argparse.ArgumentParser(description="baselines of the diagnosis on a blind set")
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of `seatsim blind make`")
    parser.add_argument("--sealed", type=Path, required=True, help="its sealed file")
    parser.add_argument("--key", required=True, help="the key that `blind make` printed")
    options = parser.parse_args()
    labels = unseal(options.sealed, options.key, options.folder).labels
    wanted = [(options.folder / case / name, method) for case in labels for name, method in BASELINES.items()]
    diagnose_missing(wanted)
    show_scores(options.folder, labels)


if __name__ == "__main__":
    main()
