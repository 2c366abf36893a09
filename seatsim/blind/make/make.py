"""Makes a set of cases: recordings without labels, and the labels sealed.

Every case has its own generator, spawned from the seed, so a set is the same in any order and with any number of
processes, and one that was broken off goes on.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.random import Generator

from seatsim.blind.labels import Label
from seatsim.blind.make.compose import compose
from seatsim.blind.make.draw_case import CaseSpecification, draw_case
from seatsim.blind.make.folder import encode_recording, write_folder
from seatsim.blind.make.unfinished import begin_or_resume, case_name, gather, is_finished, keep_label, keep_unseen
from seatsim.blind.sealed import seal
from seatsim.schema.errors import InputError
from seatsim.schema.processes import Progress, run_jobs

Wanted = TypeVar("Wanted")


class CaseFiles(NamedTuple):
    """A case as it is written: files of its recording and of the unseen one, by name, and its label."""

    recording: dict[str, bytes]
    unseen: dict[str, bytes]
    label: Label


Draw = Callable[[Wanted, Generator], CaseFiles]
"""Draws a case of what is wanted; it must be picklable, for other processes."""


def make(
    cases: int, seed: int | None, out: str | Path, sealed: str | Path, progress: Progress | None = None,
    kinds: str | Sequence[str] | None = None, processes: int = 2,
) -> str:  # fmt: skip
    """Write a set on simulated rigs; return the key.

    `kinds` is a preset (`mixed`, `varied`, `null`, `background`) or a list of kinds (none, one, two, outside) that is
    gone through in turn. The rest is that of `make_set`.

    Raises:
        InputError: fewer than one case, an unknown preset, a folder or file that is another set's.
    """

    def order(seed: int) -> Sequence[CaseSpecification]:
        return compose(cases, kinds, np.random.default_rng(np.random.SeedSequence(seed).spawn(1)[0]))

    return make_set(cases, seed, kinds, Path(out), Path(sealed), order, draw_files, progress, processes)


def make_set(
    cases: int, seed: int | None, kinds: str | Sequence[str] | None, folder: Path, target: Path,
    order: Callable[[int], Sequence[Wanted]], draw: Draw[Wanted], progress: Progress | None, processes: int,
) -> str:  # fmt: skip
    """Write `folder`/case-0001/... and the sealed file `target`; return the key, which is stored nowhere.

    Without `seed` one is drawn and sealed. `order` returns what each case is to be, by seed. A call broken off goes on
    where it stopped. `progress` is called with the cases done and all cases.

    Raises:
        InputError: fewer than one case, a folder or file that is another set's, or what `order` and `draw` raise.
    """
    partial = target.with_name(f"{target.name}.partial")
    if target.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{target}: lies inside {folder}; the labels must lie elsewhere than the recordings")
    state = begin_or_resume(cases, seed, kinds, folder, target, partial)
    wanted = order(state["seed"])
    todo = [k for k in range(cases) if not is_finished(folder, partial, case_name(k))]
    done_before = cases - len(todo)
    if progress:
        progress(done_before, cases)
    jobs = [(draw, k, wanted[k], state["seed"], folder, partial) for k in todo]
    run_jobs(make_case, jobs, processes, progress and (lambda done, _: progress(done_before + done, cases)))
    seal(target, folder, state["key"], gather(state, partial))
    shutil.rmtree(partial)
    return state["key"]


def make_case(draw: Draw[Wanted], k: int, wanted: Wanted, seed: int, folder: Path, partial: Path) -> None:
    """Draw the case with index k of a set and write its recording, its unseen run and, last, its label."""
    name = case_name(k)
    case = draw(wanted, np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, k))))
    keep_unseen(partial, name, case.unseen)
    if (folder / name).is_dir():
        shutil.rmtree(folder / name)
    write_folder(folder / name, case.recording)
    keep_label(partial, name, case.label)


def draw_files(specification: CaseSpecification, rng: Generator) -> CaseFiles:
    """Draw a case on a simulated rig, whose last run is the unseen one."""
    case = draw_case(specification, rng)
    last = len(case.experiment.runs) - 1
    recording = encode_recording(case.experiment, case.readings, rng, range(last))
    return CaseFiles(recording, encode_recording(case.experiment, case.readings, rng, [last]), case.label())
