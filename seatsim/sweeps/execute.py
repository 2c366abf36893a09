"""Carry out a sweep in a folder: check, lock, compare with what is there, simulate what is missing, keep it."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, closing, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

from seatsim.provenance.statement import Manifest
from seatsim.scenario.numbers import find_unit
from seatsim.schema.content import Form, Joined, Unwritten
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.fields import validated
from seatsim.schema.guarded import uncut
from seatsim.sweeps import parts
from seatsim.sweeps.definition import SweepDefinition, read_definition
from seatsim.sweeps.engines import FAILED, Engine, LocalEngine, Outcome, Work
from seatsim.sweeps.folder import check_resumable, count_states, hold_file, hold_folder, identify_sweep, write_manifest
from seatsim.sweeps.plan import Plan, check_plan, make_plan

if TYPE_CHECKING:
    import pandas as pd

_FLUSH = 1.0
"""Seconds between two times at which unfinished parts are written: what a killed process may lose."""
_Progress = Callable[[int, int], None]
"""Is called with how many runs have ended, and of how many."""


class Share(NamedTuple):
    """Share `number` of `of` shares of a sweep: every so-manieth part, for one command among several."""

    number: int
    of: int


def read_share(text: str) -> Share:
    """Return the share that an option states as `K/N`.

    Raises:
        InputError: it is no such share.
    """
    number, sign, of = text.partition("/")
    if not (sign and number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        raise InputError(f"--part {text}: write K/N with K from 1 to N, such as --part 2/8")
    return Share(int(number), int(of))


class SweepResult(NamedTuple):
    """A sweep after a command: the content of its `manifest.json`, and the reasons of the runs that failed.

    `made` is what the manifest says of the command, None where Python alone is at work.
    """

    folder: Unwritten[Path]
    identity: str
    counts: Mapping[str, int]
    limits: Mapping[str, float]
    failures: Annotated[list[str], Form(key="failed")]
    made: Joined[Manifest | None]


class _PreparedSweep(NamedTuple):
    """A sweep file and its runs, checked; `doubts` say what is permitted but unusual."""

    definition: SweepDefinition
    plan: Plan
    doubts: list[str]


def prepare(path: Path) -> _PreparedSweep:
    """Read a sweep file, resolve its design and check its values; nothing runs.

    Raises:
        InputError: anything in it is wrong, or a draw is not permitted.
    """
    definition = read_definition(path)
    plan = make_plan(definition)
    return _PreparedSweep(definition, plan, check_plan(plan))


def open_engine(
    name: str, jobs: int, address: str | None, keep_histories: bool = False
) -> AbstractContextManager[Engine]:
    """Return what opens the engine that is called `name`: so many runs at once, or on the scheduler at an address.

    Raises:
        InputError: the engine is not available here, or it takes no address, or keeps no histories.
    """
    if address is not None and name != "dask":
        raise InputError(f"--address {address}: engine '{name}' takes none; add --engine dask")
    if name == "cuda":
        from seatsim.sweeps.device import CudaEngine, check_device

        check_device(keep_histories)
        return nullcontext(CudaEngine(jobs))
    if name == "dask":
        from seatsim.sweeps.cluster import open_cluster

        return open_cluster(jobs, address)
    return nullcontext(LocalEngine(jobs))


def execute(
    prepared: _PreparedSweep,
    folder: Path,
    engine: Engine,
    resume: bool = False,
    keep_histories: bool = False,
    share: Share | None = None,
    progress: _Progress = lambda done, runs: None,
) -> SweepResult:
    """Carry out a sweep, or what is missing of it with `resume`, and keep its rows in a folder.

    On an interrupt what has ended is kept. A `share` is a part of the sweep that other commands complete.

    Raises:
        InputError: the folder is held by another process, holds another sweep, or `resume` is not set.
    """
    definition, plan = prepared.definition, prepared.plan
    with hold_folder(folder, f"{share.number}-of-{share.of}" if share else ""):
        identity = identify_sweep(definition, plan)
        # The first of several shares makes the manifest, which the others then find.
        with hold_file(folder / ".lock-manifest", wait=True):
            check_resumable(folder, identity, resume)
            states = [state for _, state, _ in parts.read_states(folder, plan.runs)]
            write_manifest(folder, identity, definition.limits, count_states(states, plan.runs))
        rows = _Rows(folder, plan, share, progress)
        try:
            histories = folder / "histories" if keep_histories else None
            with closing(engine(Work(plan, rows.missing(), histories))) as arriving:
                for outcomes in arriving:
                    rows.add(outcomes)
            if left := sum(map(len, rows.missing())):
                raise RunError(f"{folder}: the engine ended without {left} of its runs; go on with --resume")
        finally:
            with uncut, hold_file(folder / ".lock-manifest", wait=True):
                rows.flush()
                found = list(parts.read_states(folder, plan.runs))
                counts = count_states((state for _, state, _ in found), plan.runs)
                stated = write_manifest(folder, identity, definition.limits, counts)
    failures = [f"run {run}: {reason}" for run, state, reason in found if state == FAILED]
    known = {key: value for key, value in stated.items() if key in Manifest._fields}
    made = validated(Manifest, known) if "command" in known else None
    return SweepResult(folder, identity.digest, counts, definition.limits, failures, made)


def sweep(file: str | Path, out: str | Path, jobs: int | None = None, resume: bool = False) -> pd.DataFrame:
    """Carry out a sweep file on this machine, keep its rows in the folder `out`, and return them.

    Args:
        file: the sweep file.
        out: the folder, as `seatsim sweep --out` has it.
        jobs: runs at once; all processors where it is not stated.
        resume: go on with the sweep in the folder.

    Returns:
        The rows as `seatsim.read_sweep` returns them.

    Raises:
        InputError: the file is wrong, or the folder holds a sweep and `resume` is not set, or another sweep.
    """
    execute(prepare(Path(file)), Path(out), LocalEngine(jobs or os.cpu_count() or 1), resume)
    return parts.read_sweep(out)


class _Rows:
    """The rows of the parts of a share, or of all, that are not complete yet."""

    def __init__(self, folder: Path, plan: Plan, share: Share | None, progress: _Progress) -> None:
        self._folder, self._plan, self._progress = folder, plan, progress
        units = {key: find_unit(plan.scenario(0), key) for key in parts.varied_keys(plan)}
        self._schema = parts.make_schema(plan, units)
        self._open: dict[int, dict[int, Outcome]] = {}
        self._total = self._done = 0
        every = range(parts.part_of(plan.runs - 1) + 1)
        for part in every if share is None else every[share.number - 1 :: share.of]:
            found = {outcome.run: outcome for outcome in parts.read_outcomes(folder, part)}
            self._total += len(self._runs(part))
            self._done += len(found)
            if len(found) < len(self._runs(part)):
                self._open[part] = found
        self._changed: set[int] = set()
        self._flushed = time.monotonic()

    def _runs(self, part: int) -> range:
        return parts.runs_of(part, self._plan.runs)

    def missing(self) -> list[list[int]]:
        """Return the runs that have no row yet, by part."""
        return [[run for run in self._runs(part) if run not in rows] for part, rows in self._open.items()]

    def add(self, outcomes: list[Outcome]) -> None:
        """Take outcomes in; a part that is complete is written, the others from time to time."""
        for outcome in outcomes:
            part = parts.part_of(outcome.run)
            self._open[part][outcome.run] = outcome
            self._changed.add(part)
        self._done += len(outcomes)
        self._progress(self._done, self._total)
        for part in {parts.part_of(outcome.run) for outcome in outcomes}:
            if len(self._open[part]) == len(self._runs(part)):
                self._write(part)
                del self._open[part]
        if time.monotonic() - self._flushed > _FLUSH:
            self.flush()

    def flush(self) -> None:
        """Write the parts that have rows which are not on the disk."""
        for part in sorted(self._changed):
            self._write(part)
        self._flushed = time.monotonic()

    def _write(self, part: int) -> None:
        parts.write_outcomes(self._folder, part, self._plan, self._schema, self._open[part].values())
        self._changed.discard(part)
