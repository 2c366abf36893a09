"""One noise model in place of the passes: `python benchmarks/diagnosis_noise_model.py DIR --sealed FILE --key KEY`.

The diagnosis meets what no effect explains in several passes: broadband residuals, random forces, wandering zeros, and
a second search by the gap. Here all of it is one random process in every channel, with a smooth spectrum that is
estimated together with each set of effects. With P the power of the noise that is known and E the spectrum of the
residuals,

    S(f) = max(P(f), |E(f)|^2 smoothed),    log evidence = -sum(log S(f) + |E(f)|^2 / S(f)) - k/2 log n,

summed over channels and frequencies, judges all sets of effects at once, with k their free parameters and n the numbers
compared. Sets are fitted with the weights P, and once more with the spectrum that the rig without effects leaves. The
set with the highest evidence is stated; `unknown` where it leaves a material gap, `none` where it is empty and
leaves none. The unknown input of a block is sought as in the full method.

Written is `CASE/one-noise-model/diagnosis.json`; the table stands beside the full method, `CASE/diagnosis`, which
`seatsim blind score` writes.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from cases import EncodedDiagnosis, diagnose_cases, make_parser, open_labels, show_scores
from numpy.typing import NDArray

from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.localise.localisation import localise_remainder, share_gap
from seatsim.diagnosis.movement import is_material, measure_remainders
from seatsim.diagnosis.noise import NoiseWeights, weigh_noise
from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.probability import weigh_effects
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.select import select_effects
from seatsim.diagnosis.spectra import smooth_spectrum
from seatsim.effects.base import EFFECTS
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import load_recording

Array = NDArray[np.float64]
DOUBT = np.log(3.0)
"""Logarithm of the Bayes factor below which two sets of a size are equivalent, as in the full method."""


def measure_processes(objective: Objective, evaluation: Evaluation) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return by run the power of the residuals, and its smooth spectrum, not below the noise, by channel and frequency."""
    powers, spectra = {}, {}
    for run, noise in objective.weights.power.items():
        power = np.abs(np.fft.rfft(evaluation.residuals[run], axis=1)[:, : noise.shape[1]]) ** 2
        powers[run] = power
        spectra[run] = np.maximum(noise, smooth_spectrum(power, objective.settings.noise.smoothing))
    return powers, spectra


def weigh_evidence(objective: Objective, evaluation: Evaluation) -> float:
    """Return the logarithm of the evidence of a set of effects, the spectrum of what it leaves estimated with it."""
    powers, spectra = measure_processes(objective, evaluation)
    misfit = sum(float(np.sum(np.log(spectra[run]) + powers[run] / spectra[run])) for run in powers)
    free = sum(len(term.free) for term in evaluation.parameters.terms)
    numbers = sum(power.size for power in powers.values())
    return -misfit - 0.5 * free * float(np.log(numbers))


def fit_sets(objective: Objective) -> list[Evaluation]:
    """Return the fitted sets of effects, by the noise that is known and by what the rig without effects leaves."""
    candidates = list_candidates(objective.problem, ())
    first = select_effects(objective, candidates, lambda _: None)
    left = Objective(objective.problem, NoiseWeights(measure_processes(objective, first.calibrated)[1]))
    second = select_effects(left, candidates, lambda _: None)
    return [each for selection in (first, second) for sets in selection.sets for each in sets]


def locate(objective: Objective, calibrated: Evaluation, chosen: Evaluation, unexplained: bool) -> Sequence[Share]:
    """Return the blocks of the gap: those of the effects, and of the unknown input where something is unexplained."""
    if not unexplained:
        return share_gap(objective, chosen, None) if chosen.parameters.terms else []
    if objective.problem.bench:
        return [Share("damper", 1.0)]
    remainder, rig = localise_remainder(objective, calibrated, chosen)
    return share_gap(objective, rig, remainder)


def diagnose_by_one_noise_model(case: Path) -> EncodedDiagnosis:
    """Return the diagnosis of a case by the evidence above."""
    recording = load_recording(case)
    refuse(examine(recording))
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(recording, pool)
        objective = Objective(problem, weigh_noise(problem))
        sets = [each for each in fit_sets(objective) if is_material(problem, each)]
        weighed = sorted(((weigh_evidence(objective, each), each) for each in sets), key=lambda pair: -pair[0])
        highest, chosen = weighed[0]
        unexplained = bool(measure_remainders(problem, chosen).max() >= problem.settings.decision.material)
        calibrated = next(each for each in sets if not each.parameters.terms)
        where = locate(objective, calibrated, chosen, unexplained)
    rivals = {
        each.parameters.names
        for weight, each in weighed
        if weight > highest - DOUBT and len(each.parameters.terms) == len(chosen.parameters.terms)
    }
    groups = [sorted(frozenset.union(*rivals) - frozenset.intersection(*rivals))] if len(rivals) > 1 else []
    shares = weigh_effects([(each.parameters.names, weight) for weight, each in weighed], EFFECTS.names(), (0.0, 1.0))
    verdict = "unknown" if unexplained else "ambiguous" if groups else "known" if chosen.parameters.terms else "none"
    return {
        "verdict": verdict, "selected": sorted(chosen.parameters.names), "indistinguishable": groups,
        "causes": [{"effect": name, "probability": share} for name, share in shares.items()],
        "where": [{"block": share.block, "share": share.share} for share in where],
    }  # fmt: skip


def main() -> None:
    """Diagnose what is not diagnosed yet, and print the table."""
    options = make_parser("one noise model in place of the passes, on a blind set").parse_args()
    labels = open_labels(options)
    diagnose_cases(options.folder, list(labels), {"one-noise-model": diagnose_by_one_noise_model})
    show_scores("one noise model", options.folder, labels, ["diagnosis", "one-noise-model"])


if __name__ == "__main__":
    main()
