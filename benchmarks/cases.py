"""What the benchmarks of the diagnosis share: cases of a blind set, worked through by several methods and scored."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from seatsim.diagnosis.design.isolability import find_isolable_groups
from seatsim.diagnosis.diagnose import diagnose
from seatsim.diagnosis.noise import NoiseWeights, weigh_uniformly
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.recordings.recording import Recording
from seatsim.schema.content import to_content
from seatsim.schema.errors import SeatsimError
from seatsim.schema.files import write_json
from seatsim.schema.processes import run_jobs

EncodedDiagnosis = Mapping[str, object]
"""The content of `diagnosis.json`."""
Diagnoser = Callable[[Path], EncodedDiagnosis]
"""Diagnoses the folder of a case; it must be picklable."""
Ranked = list[tuple[str, float]]
"""Effects with a figure each, best first."""

PROCESSES = 2
"""Cases that are worked on at once."""
LEAST_NOISE = 1e-3
"""Least noise of a channel, in its standard deviations, that is taken to be stated: a weight must be finite."""


def encode_verdict(
    recording: Recording, kind: str, effects: Sequence[str], blocks: Sequence[str] = ()
) -> EncodedDiagnosis:
    """Return the content of `diagnosis.json`; blocks are those of the effects unless stated."""
    ranked = list(dict.fromkeys([*blocks, *(effect.partition(".")[0] for effect in effects)]))
    return {
        "verdict": kind,
        "where": [{"block": block, "share": 1.0 / len(ranked)} for block in ranked] if kind != "none" else [],
        "causes": [{"effect": effect, "probability": 1.0} for effect in effects],
        "selected": list(effects),
        "isolable": find_isolable_groups(recording.header.rig, recording.channels),
    }


def rank_by_figure(pairs: Sequence[tuple[str, float]]) -> Ranked:
    """Return the effects by their largest figure."""
    best: dict[str, float] = {}
    for effect, figure in pairs:
        best[effect] = max(figure, best.get(effect, 0.0))
    return sorted(best.items(), key=lambda item: -item[1])


def show_progress(done: int, total: int) -> None:
    """Tell how many jobs are done."""
    print(f"{done}/{total}", file=sys.stderr, flush=True)


def diagnose_without(without: Sequence[str], case: Path) -> EncodedDiagnosis:
    """Return seatsim's diagnosis of a case by a library without some effects."""
    return to_content(diagnose(case, without=without))


def diagnose_missing(wanted: Sequence[tuple[Path, Diagnoser]], processes: int = PROCESSES) -> None:
    """Write what methods say of cases into folders, each as `write_verdict`; a folder that is there is skipped."""
    run_jobs(write_verdict, [each for each in wanted if not each[0].is_dir()], processes, show_progress)


def write_verdict(out: Path, method: Diagnoser) -> None:
    """Write what a method says of the case that `out` lies in; one that it refuses stays without, and is wrong."""
    # Two cases are worked on at once, each with threads of its own: libraries of linear algebra get one thread each.
    with threadpool_limits(1):
        try:
            write_json(out / "diagnosis.json", method(out.parent))
        except SeatsimError as error:
            write_json(out / "error.json", {"error": str(error)})


def weigh_stated_noise(problem: DiagnosisProblem) -> NoiseWeights:
    """Return weights from the stated noise alone, the same at every frequency that is compared."""
    return weigh_uniformly(problem, np.maximum(problem.noise, LEAST_NOISE * problem.spread) ** 2)
