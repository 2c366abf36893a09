"""Baselines of the diagnosis on a blind set: `python benchmarks/diagnosis_baselines.py DIR --sealed FILE --key KEY`.

Each is given the rig with its parameters refitted inside their tolerance, and writes `CASE/BASELINE/diagnosis.json`;
cases that have one are skipped. The table says how often each is right, beside `CASE/diagnosis` where that is there.
Thresholds are for each baseline those with the most right verdicts on the first 40 of 120 development cases (11 none,
13 one effect, 7 two, 9 outside), a second effect beside a right single one counted as wrong; chosen once, then frozen.

correlation  Cosine, by channel over all runs, of the residual with what each candidate at its start changes. The effect
    with the largest |cosine| is named from NAMED on. It is then projected out of each channel, and a second one is
    named from NAMED_NEXT on. Below NAMED: `unknown` where a channel is off, beyond its noise, by LARGE of its standard
    deviation, else `none`.
bic  Forward selection with seatsim's own candidates and fits, chi^2 from the stated noise as if it were white,
    BIC = N ln(chi^2 / N) + k ln N with N the numbers compared and k the free parameters of the effects, up to three
    effects while BIC falls, ranked by how much they move; `unknown` where chi^2 / N stays above MISFIT.
sindy  Sparse regression (STLSQ of pysindy) of what equations leave that are fed measured signals, on terms that each
    stand for one effect (EQUATIONS), all in units of what noise alone leaves there. An effect is worth what its terms
    take off an equation; named from TERM on, a second one from TERM_NEXT on. Where an equation keeps more than LEFT:
    `unknown`, in its block.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from unittest.mock import patch

import numpy as np
from cases import (
    Array,
    Content,
    Method,
    Ranked,
    can_be_fed,
    diagnose_cases,
    make_parser,
    open_labels,
    rank_by_figure,
    show,
    uniform_weights,
)
from regressed import regressed

from seatsim.diagnosis import select as searching
from seatsim.diagnosis.candidates import candidates
from seatsim.diagnosis.decide import movements
from seatsim.diagnosis.design.isolability import find_isolable_groups
from seatsim.diagnosis.fit import Engine, Point, State
from seatsim.diagnosis.problem import Problem, problem
from seatsim.recordings.recording import load_recording

NAMED, NAMED_NEXT, LARGE = 0.85, 0.8, 0.02
MISFIT = 8.0
TERM, TERM_NEXT, LEFT = 0.4, 1.2, 2.0


def verdict(posed: Problem, kind: str, effects: Sequence[str], blocks: Sequence[str] = ()) -> Content:
    """Return the content of `diagnosis.json`; blocks are those of the effects unless stated."""
    ranked = list(dict.fromkeys([*blocks, *(effect.partition(".")[0] for effect in effects)]))
    return {
        "verdict": kind,
        "where": [{"block": block, "share": 1.0 / len(ranked)} for block in ranked] if kind != "none" else [],
        "causes": [{"effect": effect, "probability": 1.0} for effect in effects],
        "selected": list(effects), "indistinguishable": [],
        "isolable": find_isolable_groups(posed.recording.header.rig, posed.recording.channels),
    }  # fmt: skip


def calibrated(engine: Engine) -> State:
    """Return the nominal rig with its parameters refitted inside their tolerance."""
    state = engine.states([Point(engine.problem.rest)])[0]
    for _ in range(2):
        engine.refresh(state)
        state = engine.fitted(state)
    return state


def correlation(case: Path) -> Content:
    """Return the verdict by correlation."""
    posed = problem(load_recording(case))
    engine = Engine(posed, uniform_weights(posed))
    off, first, second = correlations(engine, calibrated(engine))
    if first[0][1] < NAMED:
        return verdict(posed, "unknown" if off > LARGE else "none", [], [first[0][0].partition(".")[0]])
    named = [first[0][0]] + [effect for effect, cosine in second[:1] if cosine >= NAMED_NEXT]
    return verdict(posed, "known", named)


def correlations(engine: Engine, state: State) -> tuple[float, Ranked, Ranked]:
    """Return the largest gap of a channel beyond its noise, the effects by |cosine|, and again without the first."""
    posed = engine.problem
    offered = candidates(posed)
    starts = engine.states([Point(state.point.u, (c,), (np.array(c.start),)) for c in offered])
    residual = _pooled(state, posed)
    changes = [(c.effect, residual - _pooled(s, posed)) for c, s in zip(offered, starts, strict=True)]
    power = np.mean(residual**2, axis=1) - posed.noise**2
    off = float(np.max(np.sqrt(power.clip(0.0)) / posed.spread))
    cosines = [(effect, _cosine(residual, change, posed)) for effect, change in changes]
    best = max(range(len(cosines)), key=lambda k: cosines[k][1])
    first, change = changes[best]
    share = np.sum(residual * change, axis=1) / np.maximum(np.sum(change**2, axis=1), 1e-30)
    rest = residual - share[:, None] * change
    again = [(effect, _cosine(rest, other, posed)) for effect, other in changes if effect != first]
    return off, rank_by_figure(cosines), rank_by_figure(again)


def _pooled(state: State, posed: Problem) -> Array:
    return np.concatenate([state.residual[run] for run in posed.runs], axis=1)


def _cosine(residual: Array, change: Array, posed: Problem) -> float:
    """Return the largest |cosine| of a channel, 0 where the change leaves the bounds or is no change."""
    size = np.linalg.norm(change, axis=1)
    seen = np.isfinite(size) & (size > 1e-6 * posed.spread * np.sqrt(change.shape[1]))
    if not np.any(seen):
        return 0.0
    product = np.abs(np.sum(residual[seen] * change[seen], axis=1))
    return float(np.max(product / (size[seen] * np.linalg.norm(residual[seen], axis=1))))


def bic(case: Path) -> Content:
    """Return the verdict by BIC."""
    posed = problem(load_recording(case))
    engine = Engine(posed, uniform_weights(posed))
    chosen, misfit = selected(engine)
    sizes = [float(np.mean(move**2)) for move in movements(engine, chosen)]
    ranked = rank_by_figure([(term.effect, size) for term, size in zip(chosen.point.terms, sizes, strict=True)])
    kind = "unknown" if misfit > MISFIT else "known" if ranked else "none"
    return verdict(posed, kind, [effect for effect, _ in ranked])


def selected(engine: Engine) -> tuple[State, float]:
    """Return the set from which BIC falls no more, and its chi^2 / N."""
    with patch.multiple(searching, WORTHWHILE=np.inf, PROMISING=1e9, NOTHING=-1.0):
        found = searching.search(engine, candidates(engine.problem), lambda _: None)
    best = [sets[0] for sets in found.sets]
    worth = [
        found.rows * np.log(state.cost / found.rows) + sum(len(t.free) for t in state.point.terms) * np.log(found.rows)
        for state in best
    ]
    size = next((k for k in range(len(best) - 1) if worth[k + 1] >= worth[k]), len(best) - 1)
    return best[size], best[size].cost / found.rows


def sindy(case: Path) -> Content:
    """Return the verdict by sparse regression."""
    posed = problem(load_recording(case))
    if not can_be_fed(posed):
        return verdict(posed, "unknown", [], ["damper"])
    ranked, left = regressed(posed)
    block = max(left, key=lambda name: left[name])
    named = [effect for effect, worth in ranked[:1] if worth >= TERM]
    named += [effect for effect, worth in ranked[1:2] if named and worth >= TERM_NEXT]
    if left[block] > LEFT:
        return verdict(posed, "unknown", named, [block])
    return verdict(posed, "known" if named else "none", named)


BASELINES: dict[str, Method] = {"correlation": correlation, "bic": bic, "sindy": sindy}


def main() -> None:
    """Diagnose what is not diagnosed yet, and print the table."""
    options = make_parser("baselines of the diagnosis on a blind set").parse_args()
    labels = open_labels(options)
    diagnose_cases(options.folder, list(labels), BASELINES)
    show("baselines", options.folder, labels, [*BASELINES, "diagnosis"])


if __name__ == "__main__":
    main()
