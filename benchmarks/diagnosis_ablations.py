"""What each part of the diagnosis is worth: `python benchmarks/diagnosis_ablations.py DIR --sealed FILE --key KEY`.

The cases of a blind set are diagnosed with one part taken away, by replacing a function or a constant while a case is
diagnosed, into `CASE/without-PART/diagnosis.json`; cases that have one are skipped. The table stands beside the full
method, `CASE/diagnosis`, which `seatsim blind score` writes.

blocks       The effects found say where the gap lies; what they do not explain is put into the damper.
nuisance     The parameters stay at their nominal values.
instruments  Effects are sought and judged with every block fed measured signals (`cases.fed`), in place of the rig that
             the recorded floor and command drive alone; what the noise of these signals leaves is simulated on a twin
             and added to the weights. Place and claim are the full method's.
null         A gap is one where chi^2 exceeds what noise alone exceeds in 1 % of cases, without the share of the signal
             that a right model may miss.
material     An effect of any size counts.
whitening    Weights are the stated noise alone, the same at all frequencies.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from types import ModuleType
from unittest.mock import patch

import numpy as np
from cases import (
    Array,
    Content,
    can_be_fed,
    diagnose_cases,
    fed,
    make_parser,
    open_labels,
    replicate,
    show,
    uniform_weights,
)
from seatsim.diagnosis.localise.localise import places

from seatsim.cli.outputs.diagnosis import encode_diagnosis
from seatsim.diagnosis import decide as judging
from seatsim.diagnosis import diagnose as diagnosing
from seatsim.diagnosis import noise as weighing
from seatsim.diagnosis import problem as posing
from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.decide import Judgement, judged
from seatsim.diagnosis.fit import Engine, State
from seatsim.diagnosis.problem import POOL, Problem
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.select import Search, search
from seatsim.schema.errors import RunError

ONE_PERCENT = 2.33
"""Standard deviations of chi^2 that noise alone exceeds in 1 % of cases."""


def places_of_effects(engine: Engine, chosen: State, rest: object) -> list[Share]:
    """Return the blocks of the effects found, after the damper where something is unexplained."""
    found = places(engine, chosen, None)
    if rest is None:
        return found
    beside = 0.4 if found else 0.0
    return [Share("damper", 1.0 - beside), *(share._replace(share=beside * share.share) for share in found)]


def judged_by_chance(engine: Engine, found: Search, effects: list[str]) -> Judgement:
    """Return the verdict with the textbook's bound on chi^2 / N - 1, whose standard deviation is sqrt(2 / N)."""
    with patch.object(judging, "NOTHING", ONE_PERCENT * np.sqrt(2.0 / found.rows)):
        return judged(engine, found, effects)


def search_fed(
    engine: Engine, candidates: Sequence[Candidate], progress: Callable[[str], None], *largest: int
) -> Search:
    """Search with all blocks fed measured signals."""
    if not can_be_fed(engine.problem):
        return search(engine, candidates, progress, *largest)
    with patch.object(Problem, "residuals", residuals_fed):
        return search(engine_fed(engine), candidates, progress, *largest)


def judged_fed(engine: Engine, found: Search, effects: list[str]) -> Judgement:
    """Judge with all blocks fed measured signals, and hand on states of the free-running rig."""
    if not can_be_fed(engine.problem):
        return judged(engine, found, effects)
    with patch.object(Problem, "residuals", residuals_fed):
        judgement = judged(engine_fed(engine), found, effects)
    found.sets[0][0], chosen = engine.states([found.calibrated.point, judgement.chosen.point])
    engine.refresh(chosen)
    return dataclasses.replace(judgement, chosen=chosen)


def residuals_fed(problem: Problem, points: Sequence[tuple[Array, Sequence[object]]]) -> list[dict[str, Array]]:
    """Return `measured - said` of every run at each point (parameters, effects), as `Problem.residuals` does."""

    def residual(job: tuple[int, str]) -> Array:
        try:
            return problem.measured[job[1]] - fed(problem, job[1], *points[job[0]])
        except RunError:
            return np.full(problem.measured[job[1]].shape, np.inf)

    jobs = [(index, run) for index in range(len(points)) for run in problem.runs]
    found: list[dict[str, Array]] = [{} for _ in points]
    for (index, run), values in zip(jobs, POOL.map(residual, jobs), strict=True):
        found[index][run] = values
    return found


def engine_fed(engine: Engine) -> Engine:
    """Return an engine whose weights hold, beside what they held, what noise leaves where measured signals are fed."""
    problem, quiet, weights = engine.problem, replicate(engine.problem), {}
    for run, held in engine.white.weights.items():
        left = quiet.measured[run] - fed(quiet, run, problem.rest, ())
        power = weighing.smoothed(np.abs(np.fft.rfft(left, axis=1)) ** 2)[:, : held.shape[1]]
        weights[run] = 1.0 / np.sqrt(1.0 / held**2 + 0.5 * power)
    return Engine(problem, dataclasses.replace(engine.white, weights=weights))


PARTS: Mapping[str, Sequence[tuple[ModuleType, str, object]]] = {
    "blocks": [(diagnosing, "places", places_of_effects)],
    "nuisance": [(posing, "nuisances", lambda scenario, tolerance: [])],
    "instruments": [(diagnosing, "search", search_fed), (diagnosing, "judged", judged_fed)],
    "null": [(weighing, "TRUST", 0.0), (diagnosing, "judged", judged_by_chance)],
    "material": [(judging, "MATERIAL", 0.0)],
    "whitening": [(diagnosing, "whitening", uniform_weights)],
}
"""What is replaced by what: module, name, value; a name that is gone is an AttributeError."""


def diagnose_without(part: str, case: Path) -> Content:
    """Return the diagnosis of a case without a part."""
    with ExitStack() as stack:
        for module, name, value in PARTS[part]:
            stack.enter_context(patch.object(module, name, value))
        return encode_diagnosis(diagnosing.diagnose(case))


def main() -> None:
    """Diagnose what is not diagnosed yet, and print the table."""
    parser = make_parser("what each part of the diagnosis is worth, on a blind set")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="the parts to take away")
    options = parser.parse_args()
    labels = open_labels(options)
    methods = {f"without-{part}": partial(diagnose_without, part) for part in options.parts}
    diagnose_cases(options.folder, list(labels), methods)
    show("diagnosis without one part", options.folder, labels, ["diagnosis", *methods])


if __name__ == "__main__":
    main()
