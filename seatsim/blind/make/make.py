"""Makes a set of cases: recordings without labels, and the labels sealed.

Every case has its own generator, spawned from the seed, so a set is the same in any order and with any number of
processes.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from seatsim.blind.make.compose import compose
from seatsim.blind.make.draw_case import CaseSpecification, draw_case
from seatsim.blind.make.folder import encode_recording, write_folder
from seatsim.blind.make.unfinished import (
    begin_or_resume,
    case_name,
    gather,
    is_finished,
    keep_label,
    keep_unseen,
)
from seatsim.blind.processes import Progress, run_jobs
from seatsim.blind.sealed import seal
from seatsim.schema.errors import InputError


def make(
    cases: int, seed: int | None, out: str | Path, sealed: str | Path, progress: Progress | None = None,
    kinds: str | Sequence[str] | None = None, processes: int = 2,
) -> str:  # fmt: skip
    """Write DIR/case-0001/... and the sealed file; return the key, which is stored nowhere.

    Without `seed` one is drawn and sealed. `kinds` is a preset (`mixed`, `varied`, `null`, `background`) or a list of
    kinds (none, one, two, outside) that is gone through in turn. A call broken off goes on where it stopped. `progress`
    is called with the cases done and all cases.

    Raises:
        InputError: fewer than one case, an unknown preset, a folder or file that is another set's.
    """
    folder, target = Path(out), Path(sealed)
    partial = target.with_name(f"{target.name}.partial")
    if target.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{target}: lies inside {folder}; the labels must lie elsewhere than the recordings")
    state = begin_or_resume(cases, seed, kinds, folder, target, partial)
    root = np.random.SeedSequence(state["seed"])
    specifications = compose(cases, kinds, np.random.default_rng(root.spawn(1)[0]))
    todo = [k for k in range(cases) if not is_finished(folder, partial, case_name(k))]
    done_before = cases - len(todo)
    if progress:
        progress(done_before, cases)
    jobs = [(k, specifications[k], state["seed"], folder, partial) for k in todo]
    run_jobs(make_case, jobs, processes, progress and (lambda done, _: progress(done_before + done, cases)))
    seal(target, folder, state["key"], gather(state, partial))
    shutil.rmtree(partial)
    return state["key"]


def make_case(k: int, specification: CaseSpecification, seed: int, folder: Path, partial: Path) -> None:
    """Draw the case with index k of a set and write its recording, its unseen run and, last, its label."""
    name = case_name(k)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, k)))
    case = draw_case(specification, rng)
    last = len(case.experiment.runs) - 1
    files = encode_recording(case.experiment, case.readings, rng, range(last))
    keep_unseen(partial, name, encode_recording(case.experiment, case.readings, rng, [last]))
    if (folder / name).is_dir():
        shutil.rmtree(folder / name)
    write_folder(folder / name, files)
    keep_label(partial, name, case.label())
