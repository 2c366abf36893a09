"""What each part of the diagnosis is worth: `python benchmarks/diagnosis_ablations.py DIR --sealed FILE --key KEY`.

The cases of a blind set are diagnosed with one part taken away, by other thresholds or by another stage of the method,
into `CASE/without-PART/diagnosis.json`; cases that have one are skipped. The table stands beside the full method,
`CASE/diagnosis`, which `seatsim blind score` writes.

blocks       The effects found say where the gap lies; what they do not explain is put into the damper.
nuisance     The parameters stay at their nominal values.
instruments  Effects are sought and judged with every block fed measured signals (`measured_motion`), in place of the
             rig that the recorded floor and command drive alone; what the noise of these signals leaves is simulated on
             a replicate and added to the weights. Localisation and hold-out validation are the full method's.
null         A gap is one where chi^2 exceeds what noise alone exceeds in 1 % of cases, without the share of the signal
             that a right model may miss.
material     An effect of any size counts.
whitening    Weights are the stated noise alone, the same at all frequencies.
shortcuts    Every candidate is fitted to its end, from every start, and every set is enlarged by every effect: the
             verdicts should be those of the full method, which saves this time.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from cases import EncodedDiagnosis, diagnose_cases, make_parser, open_labels, show_scores, weigh_stated_noise
from measured_motion import feed_objective, feed_problem, has_measured_motion

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.decide import Decision, decide_verdict
from seatsim.diagnosis.diagnose import diagnose_problem
from seatsim.diagnosis.localise.localisation import Remainder, share_gap
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.problem import DiagnosisProblem, pose_problem
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.select import LinearisedRig, Selection, select_effects
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.solution import Method
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import load_recording
from seatsim.schema.content import to_content

ONE_PERCENT = 2.33
"""Standard deviations of chi^2 that noise alone exceeds in 1 % of cases."""
BESIDE_DAMPER = 0.4
"""Share of the effects found where the damper is blamed for what they do not explain."""
FULL = DiagnosisSettings()
EVERY = 1000
EXHAUSTIVE = FULL._replace(
    fit=FULL.fit._replace(settled=1e-6, most_steps=12),
    selection=FULL.selection._replace(
        first_shortlist=EVERY, further_shortlist=EVERY, finalists=EVERY, beam=4, promising=float("inf"),
        swap_within=float("inf"), most_swaps=EVERY,
    ),
)  # fmt: skip
"""Settings without the shortcuts of the search."""


class Ablation(NamedTuple):
    """The diagnosis without one part: its thresholds and stages, and whether parameters vary within their tolerance."""

    settings: DiagnosisSettings = FULL
    method: Method = Method()
    vary_parameters: bool = True


@dataclasses.dataclass(frozen=True)
class FedSelection(Selection):
    """A selection on a rig that is fed measured signals, `fed`, with the calibrated rig evaluated by `free`.

    What follows the decision is the full method's, and simulates the rig without such a feed.
    """

    fed: Selection
    free: Objective


def share_by_effects(objective: Objective, chosen: Evaluation, remainder: Remainder | None) -> list[Share]:
    """Return the blocks of the effects found, after the damper where something is unexplained."""
    found = share_gap(objective, chosen, None)
    if remainder is None:
        return found
    beside = BESIDE_DAMPER if found else 0.0
    return [Share("damper", 1.0 - beside), *(share._replace(share=beside * share.share) for share in found)]


def decide_by_chance(problem: DiagnosisProblem, selection: Selection, effects: Sequence[str]) -> Decision:
    """Return the verdict with the textbook's bound on chi^2 / N - 1, whose standard deviation is sqrt(2 / N)."""
    bound = ONE_PERCENT * float(np.sqrt(2.0 / selection.calibrated.rows))
    settings = problem.settings._replace(selection=problem.settings.selection._replace(nothing_left=bound))
    return decide_verdict(dataclasses.replace(problem, settings=settings), selection, effects)


def select_fed(
    objective: Objective, candidates: Sequence[Candidate], progress: Callable[[str], object], largest: int | None,
    rig: LinearisedRig | None = None,
) -> Selection:  # fmt: skip
    """Select effects with all blocks fed measured signals, where these were recorded."""
    if not has_measured_motion(objective.problem):
        return select_effects(objective, candidates, progress, largest, rig)
    fed = select_effects(feed_objective(objective), candidates, progress, largest)
    calibrated = objective.evaluate([fed.calibrated.parameters])[0]
    return FedSelection(fed.nominal, ((calibrated,), *fed.sets[1:]), fed.linearisations, fed, objective)


def decide_fed(problem: DiagnosisProblem, selection: Selection, effects: Sequence[str]) -> Decision:
    """Decide with all blocks fed measured signals, and hand on the chosen rig without that feed."""
    if not isinstance(selection, FedSelection):
        return decide_verdict(problem, selection, effects)
    decision = decide_verdict(feed_problem(problem), selection.fed, effects)
    return dataclasses.replace(decision, chosen=selection.free.evaluate([decision.chosen.parameters])[0])


PARTS: Mapping[str, Ablation] = {
    "blocks": Ablation(method=Method(share_gap=share_by_effects)),
    "nuisance": Ablation(vary_parameters=False),
    "instruments": Ablation(method=Method(select_effects=select_fed, decide_verdict=decide_fed)),
    "null": Ablation(
        FULL._replace(noise=FULL.noise._replace(model_error=0.0)), Method(decide_verdict=decide_by_chance)
    ),
    "material": Ablation(FULL._replace(decision=FULL.decision._replace(material=0.0))),
    "whitening": Ablation(method=Method(weigh_noise=weigh_stated_noise)),
    "shortcuts": Ablation(EXHAUSTIVE),
}
"""The diagnosis without each part."""


def diagnose_without(part: str, case: Path) -> EncodedDiagnosis:
    """Return the diagnosis of a case without a part."""
    settings, method, vary_parameters = PARTS[part]
    recording = load_recording(case)
    examination = examine(recording)
    refuse(examination)
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(recording, pool, settings)
        if not vary_parameters:
            problem = dataclasses.replace(problem, parameters=())
        return to_content(diagnose_problem(problem, examination.sentences, method=method))


def main() -> None:
    """Diagnose what is not diagnosed yet, and print the table."""
    parser = make_parser("what each part of the diagnosis is worth, on a blind set")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="the parts to take away")
    options = parser.parse_args()
    labels = open_labels(options)
    methods = {f"without-{part}": partial(diagnose_without, part) for part in options.parts}
    diagnose_cases(options.folder, list(labels), methods)
    show_scores("diagnosis without one part", options.folder, labels, ["diagnosis", *methods])


if __name__ == "__main__":
    main()
