"""From a recording to its diagnosis: examine the data, pose the problem, solve it, state the solution."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from threadpoolctl import threadpool_limits

from seatsim.diagnosis.problem import Deadline, DiagnosisProblem, check_nominal, pose_problem
from seatsim.diagnosis.result import Diagnosis
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.diagnosis.solve import solve
from seatsim.diagnosis.state import state_diagnosis
from seatsim.recordings.header import NOT_STATED, USUAL
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import Recording, join_recordings, load_recording
from seatsim.schema.errors import InputError

BUDGET = 120.0
"""s; time that a diagnosis may take unless another is asked for."""
_SEARCH_SHARE = 0.7
"""Share of it after which the search ends, so that some is left to validate and state the answer."""


def diagnose(
    recording: str | Path | Recording,
    without: Sequence[str] = (),
    progress: Callable[[str], object] = lambda _: None,
    settings: DiagnosisSettings | None = None,
    budget: float = BUDGET,
    damper_forms: bool = False,
    after: str | Path | Recording | None = None,
) -> Diagnosis:
    """Say where the gap between a recording and its nominal scenario lies, what causes it, and how far it shrinks.

    Args:
        recording: a recording, or its folder.
        without: names of effects that are withheld from the library.
        progress: called with what is being done.
        settings: thresholds, those of `DiagnosisSettings` where absent.
        budget: seconds that the diagnosis may take once the nominal rig was simulated, which may have to be compiled
            first. Where they are spent the answer is the best so far, and a note says which stages were cut short.
        damper_forms: try other forms of the damper whatever the verdict, not only where much of its force stays open.
        after: a second recording of the same rig, made by the experiment that a diagnosis of the first proposed, or its
            folder; the runs of both are diagnosed together.

    Raises:
        InputError: the budget is not positive, a recording is damaged so that the verdict would be wrong, or the two
            cannot be joined.
        RunError: the nominal rig cannot be simulated in a run.
    """
    if not budget > 0.0:
        raise InputError(f"a budget of {budget:g} s is not permitted; it must be above 0")
    recording, said = _load(recording), list[str]()
    if after is not None:
        recording, said = join_recordings(recording, _load(after))
    if recording.header.parameter_tolerance is None:
        said = [
            *said,
            f"{NOT_STATED}: every parameter of the nominal scenario is taken to be known to {100 * USUAL:g} %",
        ]
    progress("looking at the data")
    examination = examine(recording)
    refuse(examination)
    with ThreadPoolExecutor() as pool:
        problem, notes = pose_problem(recording, pool, settings), [*said, *examination.sentences]
        return diagnose_problem(problem, notes, without, progress, budget=budget, damper_forms=damper_forms)


def _load(recording: str | Path | Recording) -> Recording:
    """Return the recording that a path names, read from its folder."""
    return recording if isinstance(recording, Recording) else load_recording(recording)


def diagnose_problem(
    problem: DiagnosisProblem,
    notes: Sequence[str] = (),
    without: Sequence[str] = (),
    progress: Callable[[str], object] = lambda _: None,
    budget: float = math.inf,
    damper_forms: bool = False,
) -> Diagnosis:
    """Return the diagnosis of a problem; `notes` are sentences on the quality of its data, `budget` is as above.

    Simulations of several runs and rigs run in parallel, so linear algebra libraries are limited to one thread.

    Raises:
        RunError: the nominal rig cannot be simulated in a run.
    """
    stages: list[tuple[str, float]] = []

    def tell(stage: str) -> None:
        stages.append((stage, time.monotonic()))
        progress(stage)

    with threadpool_limits(1):
        check_nominal(problem)
        deadline = Deadline(time.monotonic() + _SEARCH_SHARE * budget)
        solution = solve(problem.until(deadline), without, tell)
        said, began = list(notes), [at for _, at in stages[1:]] + [math.inf]
        cut = dict.fromkeys(stage for (stage, _), until in zip(stages, began, strict=True) if until > deadline.end)
        if deadline.is_past and cut:
            spent = f"the budget of {budget:g} s was spent, so that the answer is the best so far"
            said.append(f"{spent}; cut short: {', '.join(cut)}")
        solution = solution._replace(objective=solution.objective.unhurried)
        return state_diagnosis(solution, said, progress, damper_forms)
