"""Makes a set of cases: recordings without labels, and the labels sealed.

Every case has its own generator, spawned from the seed, so a set is the same in any order and with any number of
processes. While a set is unfinished its seed, key and labels lie in `SEALED.partial` (readable by the owner alone), so
that a call that was broken off goes on; the folder is deleted when the file is sealed.
"""

from __future__ import annotations

import json
import os
import secrets
import shutil
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from seatsim.blind.make.compose import compose
from seatsim.blind.make.draw import Order, draw_case
from seatsim.blind.make.folder import recording_files, write_files
from seatsim.blind.sealed import SEAL, Sealed, new_key, seal
from seatsim.schema.errors import InputError

Progress = Callable[[int, int], None]
"""Called with cases done and cases in all."""


def make(
    cases: int, seed: int | None, out: str | Path, sealed: str | Path, progress: Progress | None = None,
    kinds: str | Sequence[str] | None = None, processes: int = 2,
) -> str:  # fmt: skip
    """Write DIR/case-0001/... and the sealed file; return the key, which is stored nowhere.

    Without `seed` one is drawn and sealed. `kinds` is a preset (`mixed`, `null`, `background`) or a list of kinds
    (none, one, two, outside) that is gone through in turn. A call broken off goes on where it stopped.

    Raises:
        InputError: fewer than one case, an unknown preset, a folder or file that is another set's.
    """
    folder, target = Path(out), Path(sealed)
    partial = target.with_name(f"{target.name}.partial")
    if target.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{target}: lies inside {folder}; the labels must lie elsewhere than the recordings")
    state = _state(cases, seed, kinds, folder, target, partial)
    root = np.random.SeedSequence(int(state["seed"]))
    orders = compose(cases, kinds, np.random.default_rng(root.spawn(1)[0]))
    todo = [k for k in range(cases) if not _finished(folder, partial, _name(k))]
    if progress:
        progress(cases - len(todo), cases)
    _work([(k, orders[k], int(state["seed"]), folder, partial) for k in todo], cases, progress, processes)
    content = _gather(cases, state, partial)
    seal(target, folder, str(state["key"]), content)
    shutil.rmtree(partial)
    return str(state["key"])


def _state(
    cases: int, seed: int | None, kinds: str | Sequence[str] | None, folder: Path, target: Path, partial: Path
) -> dict[str, Any]:
    """Return seed and key of an unfinished set, or begin one."""
    if cases < 1:
        raise InputError(f"--cases {cases}: at least 1")
    wanted = {"cases": cases, "kinds": kinds if isinstance(kinds, str | None) else list(kinds)}
    note = partial / "state.json"
    if note.is_file():
        state: dict[str, Any] = json.loads(note.read_text(encoding="utf-8"))
        same = {name: state[name] for name in wanted} == wanted and (seed is None or seed == state["seed"])
        if not same:
            raise InputError(f"{partial}: holds an unfinished set made otherwise; delete it, or give another --sealed")
        return state
    if target.exists() or (folder / SEAL).exists() or any(folder.glob("case-*")):
        raise InputError(f"{folder}: {target} or a set of cases is there already; give another --out and --sealed")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        partial.mkdir(parents=True, mode=0o700)
    except OSError as error:
        raise InputError(f"{partial}: cannot be written: {error.strerror}; give another --sealed") from error
    state = wanted | {
        "seed": secrets.randbits(62) if seed is None else seed,
        "key": new_key(),
        "given": seed is not None,
    }
    handle = os.open(note, os.O_WRONLY | os.O_CREAT, 0o600)
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        json.dump(state, stream)
    return state


def _name(k: int) -> str:
    return f"case-{k + 1:04d}"


def _finished(folder: Path, partial: Path, name: str) -> bool:
    return (folder / name).is_dir() and (partial / f"{name}.json").is_file()


def _quiet() -> None:
    """Leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _work(
    jobs: list[tuple[int, Order, int, Path, Path]], cases: int, progress: Progress | None, processes: int
) -> None:
    if processes <= 1 or len(jobs) <= 1:
        for n, job in enumerate(jobs):
            make_case(*job)
            if progress:
                progress(cases - len(jobs) + n + 1, cases)
        return
    pool = ProcessPoolExecutor(min(processes, len(jobs)), mp_context=get_context("spawn"), initializer=_quiet)
    waiting: set[Future[None]] = {pool.submit(make_case, *job) for job in jobs}
    try:
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                future.result()
            if progress:
                progress(cases - len(waiting), cases)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def make_case(k: int, order: Order, seed: int, folder: Path, partial: Path) -> None:
    """Draw one case and write its recording, its unseen run and its label."""
    name = _name(k)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, k)))
    case = draw_case(order, rng)
    last = len(case.setting.runs) - 1
    files = recording_files(case.setting, case.shown, rng, list(range(last)))
    unseen = recording_files(case.setting, case.shown, rng, [last])
    (partial / name).mkdir(exist_ok=True)
    for file, content in unseen.items():
        (partial / name / file).write_bytes(content)
    if (folder / name).is_dir():
        shutil.rmtree(folder / name)
    write_files(folder / name, files)
    label = case.label() | {"order": asdict(order)}
    (partial / f"{name}.json").write_text(json.dumps(label), encoding="utf-8")


def _gather(cases: int, state: dict[str, Any], partial: Path) -> Sealed:
    names = [_name(k) for k in range(cases)]
    labels = {name: json.loads((partial / f"{name}.json").read_text(encoding="utf-8")) for name in names}
    unseen = {name: {file.name: file.read_bytes() for file in sorted((partial / name).iterdir())} for name in names}
    made = {"seed": state["seed"], "seed_given": state["given"], "cases": cases, "kinds": state["kinds"]}
    return Sealed(labels, unseen, made)
