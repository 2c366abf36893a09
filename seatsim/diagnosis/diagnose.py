"""From a recording to its diagnosis: examine the data, pose the problem, solve it, state the solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from threadpoolctl import threadpool_limits

from seatsim.diagnosis.problem import DiagnosisProblem, pose_problem
from seatsim.diagnosis.result import Diagnosis
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.solve import Method, solve
from seatsim.diagnosis.state import state_diagnosis
from seatsim.diagnosis.widen import search_wider
from seatsim.recordings.joined import join_recordings
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import Recording, load_recording


def diagnose(
    recording: str | Path | Recording, without: Sequence[str] = (), progress: Callable[[str], object] = lambda _: None,
    settings: DiagnosisSettings | None = None, after: str | Path | Recording | None = None,
) -> Diagnosis:  # fmt: skip
    """Say where the gap between a recording and its nominal scenario lies, what causes it, and how far it shrinks.

    Args:
        recording: a recording, or its folder.
        without: names of effects that are withheld from the library.
        progress: called with what is being done.
        settings: thresholds, those of `DiagnosisSettings` where absent.
        after: a second recording of the same rig, made by the experiment that a diagnosis of the first proposed, or its
            folder; the runs of both are diagnosed together.

    Raises:
        InputError: a recording is damaged in a way that would lead to a wrong verdict, or the two cannot be joined.
        RunError: a simulation could not be carried to its end.
    """
    recording, said = _load(recording), list[str]()
    if after is not None:
        recording, said = join_recordings(recording, _load(after))
    progress("looking at the data")
    examination = examine(recording)
    refuse(examination)
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(recording, pool, settings)
        return diagnose_problem(problem, [*said, *examination.sentences], without, progress)


def _load(recording: str | Path | Recording) -> Recording:
    """Return the recording that a path names, read from its folder."""
    return recording if isinstance(recording, Recording) else load_recording(recording)


def diagnose_problem(
    problem: DiagnosisProblem, notes: Sequence[str] = (), without: Sequence[str] = (),
    progress: Callable[[str], object] = lambda _: None, method: Method | None = None,
) -> Diagnosis:  # fmt: skip
    """Return the diagnosis of a problem; `notes` are sentences on the quality of its data.

    Simulations of several runs and rigs run in parallel, so linear algebra libraries are limited to one thread.
    """
    method = method or Method()
    with threadpool_limits(1):
        first = solve(problem, without, progress, method)
        solution, said = search_wider(first, without, progress, method)
        return state_diagnosis(solution, [*notes, *said], progress)
