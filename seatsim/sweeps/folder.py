"""The folder of a sweep: who holds it, which sweep it is of, how far it is, and whether it may be gone on with.

A sweep is its configuration, design, versions and seed. A lock names its owner and dies with it (flock); commands for
different shares hold the folder together, which `filelock` cannot do. `manifest.json` holds the rest.
"""

from __future__ import annotations

import hashlib
import json
import os
import socket
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from seatsim.provenance.statement import current_invocation, describe, list_versions
from seatsim.schema.content import plain, to_content
from seatsim.schema.errors import InputError
from seatsim.schema.files import make_folder, write_json
from seatsim.schema.guarded import check_no_link, expect, open_in_place, read_json
from seatsim.schema.modules import used_files
from seatsim.schema.text import cut
from seatsim.sweeps.definition import SweepDefinition
from seatsim.sweeps.engines import STATES
from seatsim.sweeps.plan import Plan

LIBRARIES = ("numpy", "scipy", "numba", "pyarrow")
"""Libraries that a figure, or the bytes of a part, may hang on."""


class _Identity(NamedTuple):
    """What a sweep is: `digest` over all the rest. `configuration` is what its files state, without the limits."""

    digest: str
    seed: int
    versions: Mapping[str, str]
    configuration: Mapping[str, object]


def identify_sweep(definition: SweepDefinition, plan: Plan) -> _Identity:
    """Return the identity of a sweep."""
    stated = {key: value for key, value in definition.source.data.items() if key not in ("scenario", "seed", "limits")}
    configuration = {"scenario": definition.scenario.data, **stated, "files": dict(_digest_files(plan))}
    versions = list_versions(LIBRARIES, used_files())
    # As it will be read from JSON, so that it equals what was written.
    read_back: dict[str, object] = json.loads(_encode(configuration))
    whole = [configuration, _digest_design(plan), versions, definition.seed]
    digest = hashlib.sha256(_encode(whole)).hexdigest()
    return _Identity(digest, definition.seed, versions, read_back)


def _digest_design(plan: Plan) -> str:
    """Return a hash over the values of the runs of a sweep."""
    state = hashlib.sha256()
    for run in range(plan.runs):
        replicate = run // (plan.points * len(plan.bases))
        state.update(json.dumps([replicate, *plan.values(run).values()], default=str).encode())
    return state.hexdigest()


def list_differences(old: object, new: object, keys: tuple[str, ...] = ()) -> Iterator[str]:
    """Yield what differs between two nested values: its dotted key, the old and the new value."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        for key in dict.fromkeys([*old, *new]):
            yield from list_differences(old.get(key), new.get(key), (*keys, str(key)))
    elif old != new:
        yield f"{'.'.join(keys)} was {_shown(old)} and is {_shown(new)}"


def _digest_files(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield the files that the scenario or the design names, such as a measured road, with a hash of their content."""
    folder = plan.bases[0].source.path.parent
    stated = [base.source.data for base in plan.bases]
    for name in sorted({*_texts(stated), *_texts(list(plan.columns.values()))}):
        path = folder / name
        if len(name) < 1000 and path.is_file():
            yield name, hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, Mapping):
        value = list(value.values())
    if isinstance(value, list | tuple):
        for item in value:
            yield from _texts(item)
    elif isinstance(value, str):
        yield value


def _encode(value: object) -> bytes:
    return json.dumps(plain(value), sort_keys=True, default=str).encode()


def _shown(value: object) -> str:
    return "absent" if value is None else cut(json.dumps(value))


@contextmanager
def hold_folder(folder: Path, share: str = "") -> Iterator[None]:
    """Hold the folder of a sweep; commands for different shares of its runs, such as `2-of-8`, hold it together.

    The system releases the locks (flock) when the process ends, however that happens. The files stay.

    Raises:
        InputError: another process holds the folder, or the same share of it; the message names that process. Or
            something in it is a link, through which rows would be written.
    """
    make_folder(folder)
    for place in folder.iterdir():
        check_no_link(folder, place)
    if not share:
        with hold_file(folder / ".lock"):
            yield
        return
    with hold_file(folder / ".lock", alone=False), hold_file(folder / f".lock-{share}"):
        yield


@contextmanager
def hold_file(path: Path, alone: bool = True, wait: bool = False) -> Iterator[None]:
    """Hold one lock file, alone or together with others that do the same; `wait` until that is possible, or fail.

    Raises:
        InputError: another process holds it.
    """
    try:
        import fcntl
    except ImportError as error:
        problem = "a sweep locks its folder with flock, which this system has not; use Linux, macOS, or Windows' WSL"
        raise InputError(problem) from error
    with open_in_place(path) as file:
        how = (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | (0 if wait else fcntl.LOCK_NB)
        try:
            fcntl.flock(file, how)
        except BlockingIOError as error:
            owner = file.read().strip() or "another process"
            problem = f"{path.parent}: {owner} works on this sweep; wait for it, end it, or choose another --out"
            raise InputError(problem) from error
        file.truncate(0)
        with suppress(OSError):  # who holds a folder is told where the disk lets it
            file.write(f"process {os.getpid()} on {socket.gethostname()}" if alone else "a command for a share of it")
            file.flush()
        yield


_NAME = "manifest.json"
_FIELDS = {"identity": str, "versions": dict, "seed": int, "counts": dict, "limits": dict, "configuration": dict}
"""What a manifest states, and of which kind each is."""


def write_manifest(
    folder: Path, identity: _Identity, limits: Mapping[str, float], counts: Mapping[str, int]
) -> dict[str, object]:
    """Write the manifest of a sweep, with what `seatsim reproduce` needs where a command is at work; return it."""
    invocation = current_invocation()
    parts = {path.relative_to(folder).as_posix(): path for path in sorted(folder.glob("runs/part-*.parquet"))}
    outputs = {} if counts["pending"] else parts
    stated = {} if invocation is None else to_content(describe(invocation, folder, outputs, identity.versions))
    content = {
        **stated,
        "identity": identity.digest,
        "versions": identity.versions,
        "seed": identity.seed,
        "counts": counts,
        "limits": limits,
        "configuration": identity.configuration,
    }
    write_json(folder / _NAME, content, lasting=True)
    return content


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest of a sweep.

    Raises:
        InputError: the folder holds no sweep.
    """
    try:
        with expect(folder / _NAME, "manifest of a sweep"):
            content: dict[str, Any] = read_json(folder / _NAME, "manifest of a sweep")
            for key, kind in _FIELDS.items():
                if not isinstance(content[key], kind):
                    raise TypeError(f"{key} is {content[key]!r}")
            content["counts"]["runs"]
    except InputError as error:
        raise InputError(f"{folder}: holds no sweep; 'seatsim sweep FILE --out {folder}' makes one") from error
    return content


def count_states(states: Iterable[str], runs: int) -> dict[str, int]:
    """Return how many runs there are, how many in each state, and how many are pending."""
    found = Counter(states)
    counts = {state: found[state] for state in STATES}
    return {"runs": runs, **counts, "pending": runs - sum(counts.values())}


def say_ended(folder: Path) -> str:
    """Return how many runs of a sweep have ended by the last count, `no run` where none was begun."""
    try:
        counts = read_manifest(folder)["counts"]
    except InputError:
        return "no run"
    return f"{counts['runs'] - counts['pending']} of {counts['runs']} runs"


def check_resumable(folder: Path, identity: _Identity, resume: bool) -> None:
    """Refuse to go on in a folder that holds another sweep.

    Raises:
        InputError: the folder holds a sweep and `resume` is not set, or one that differs; the message names how.
    """
    if not (folder / _NAME).exists():
        if any(folder.glob("runs/part-*.parquet")):
            raise InputError(f"{folder}: holds the rows of a sweep without its {_NAME}; choose another --out")
        return
    old = read_manifest(folder)
    if not resume:
        raise InputError(
            f"{folder}: holds a sweep already, {say_ended(folder)} by its last count; go on with it with --resume,"
            " or choose another --out"
        )
    if old["identity"] == identity.digest:
        return
    before = {"seed": old["seed"], "versions": old["versions"], **old["configuration"]}
    now = {"seed": identity.seed, "versions": dict(identity.versions), **identity.configuration}
    shown = "; ".join(list_differences(before, now)) or "the resolved design differs"
    raise InputError(f"{folder}: holds another sweep: {shown}; choose another --out")
