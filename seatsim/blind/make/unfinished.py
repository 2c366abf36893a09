"""What is kept of a set while it is unfinished: seed, key, labels and unseen runs, beside the file to be sealed.

They lie in `SEALED.partial`, readable by the owner alone, so that a call that was broken off goes on; the folder is
deleted when the file is sealed.
"""

from __future__ import annotations

import json
import secrets
from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict, cast

from seatsim.blind.labels import Label
from seatsim.blind.sealed import SEAL, Sealed, new_key
from seatsim.schema.errors import InputError
from seatsim.schema.files import make_folder, write_bytes, write_text


class State(TypedDict):
    """Content of `state.json`: what was asked for, and what makes the set."""

    cases: int
    kinds: str | list[str] | None
    seed: int
    key: str
    given: bool
    """Whether the seed was given; otherwise it was drawn."""


def case_name(k: int) -> str:
    """Return the name of the case with index k."""
    return f"case-{k + 1:04d}"


def begin_or_resume(
    cases: int, seed: int | None, kinds: str | Sequence[str] | None, folder: Path, target: Path, partial: Path
) -> State:
    """Return seed and key of an unfinished set, or begin one.

    Raises:
        InputError: fewer than one case, an unfinished set made otherwise, a finished one, or no right to write.
    """
    if cases < 1:
        raise InputError(f"--cases {cases}: at least 1")
    wanted = kinds if isinstance(kinds, str | None) else list(kinds)
    note = partial / "state.json"
    if note.is_file():
        state = cast(State, json.loads(note.read_text(encoding="utf-8")))
        if (state["cases"], state["kinds"]) != (cases, wanted) or seed not in (None, state["seed"]):
            raise InputError(f"{partial}: holds an unfinished set made otherwise; delete it, or give another --sealed")
        return state
    if target.exists() or (folder / SEAL).exists() or any(folder.glob("case-*")):
        raise InputError(f"{folder}: {target} or a set of cases is there already; give another --out and --sealed")
    drawn = secrets.randbits(62) if seed is None else seed
    state = {"cases": cases, "kinds": wanted, "seed": drawn, "key": new_key(), "given": seed is not None}
    _write_state(note, folder, state)
    return state


def _write_state(note: Path, folder: Path, state: State) -> None:
    """Write the note into a folder that only the owner can read, since its key opens the labels."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        note.parent.mkdir(parents=True, mode=0o700)
    except OSError as error:
        raise InputError(f"{note.parent}: cannot be written: {error.strerror}; give another --sealed") from error
    write_text(note, json.dumps(state))


def is_finished(folder: Path, partial: Path, name: str) -> bool:
    """Tell whether a case has its recording and its label, which is written last."""
    return (folder / name).is_dir() and (partial / f"{name}.json").is_file()


def keep_unseen(partial: Path, name: str, files: dict[str, bytes]) -> None:
    """Write the unseen recording of a case."""
    make_folder(partial / name)
    for file, content in files.items():
        write_bytes(partial / name / file, content)


def keep_label(partial: Path, name: str, label: Label) -> None:
    """Write the label of a case; it marks the case as finished."""
    write_text(partial / f"{name}.json", json.dumps(label))


def gather(state: State, partial: Path) -> Sealed:
    """Return what is to be sealed of a set whose cases are all finished."""
    names = [case_name(k) for k in range(state["cases"])]
    labels: dict[str, Label] = {
        name: json.loads((partial / f"{name}.json").read_text(encoding="utf-8")) for name in names
    }
    unseen = {name: {file.name: file.read_bytes() for file in sorted((partial / name).iterdir())} for name in names}
    return Sealed(
        labels,
        unseen,
        {"seed": state["seed"], "seed_given": state["given"], "cases": state["cases"], "kinds": state["kinds"]},
    )
