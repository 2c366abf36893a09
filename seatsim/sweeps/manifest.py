"""`manifest.json`: what a sweep is, how far it is, and whether it may be gone on with."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, cast

from seatsim.provenance.invocation import current_invocation
from seatsim.provenance.manifest import describe
from seatsim.schema.content import to_content
from seatsim.schema.errors import InputError
from seatsim.schema.files import write_json
from seatsim.schema.guarded import expect, read_json
from seatsim.sweeps.identity import GROWING, Identity, digest_design, list_differences
from seatsim.sweeps.outcome import STATES
from seatsim.sweeps.plan import Plan

NAME = "manifest.json"
FIELDS = {"identity": str, "versions": dict, "seed": int, "counts": dict, "limits": dict, "configuration": dict}
"""What a manifest states, and of which kind each is."""


def write_manifest(folder: Path, identity: Identity, limits: Mapping[str, float], counts: Mapping[str, int]) -> Path:
    """Write the manifest of a sweep, with what `seatsim reproduce` needs where a command is at work."""
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
        "design": identity.design,
    }
    return write_json(folder / NAME, content, lasting=True)


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest of a sweep.

    Raises:
        InputError: the folder holds no sweep.
    """
    try:
        with expect(folder / NAME, "manifest of a sweep"):
            content = cast("dict[str, Any]", read_json(folder / NAME, "manifest of a sweep"))
            for key, kind in FIELDS.items():
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


def check_resumable(folder: Path, identity: Identity, plan: Plan, resume: bool) -> None:
    """Refuse to go on in a folder that holds another sweep; one that has fewer runs of the same is extended.

    Raises:
        InputError: the folder holds a sweep and `resume` is not set, or one that differs; the message names how.
    """
    if not (folder / NAME).exists():
        if any(folder.glob("runs/part-*.parquet")):
            raise InputError(f"{folder}: holds the rows of a sweep without its {NAME}; choose another --out")
        return
    old = read_manifest(folder)
    counts = old["counts"]
    if not resume:
        raise InputError(
            f"{folder}: holds a sweep already, {say_ended(folder)} by its last count; go on with it with --resume,"
            " or choose another --out"
        )
    if old["identity"] == identity.digest:
        return
    fixed = [_without_growing(each) for each in (old["configuration"], identity.configuration)]
    differences = [
        *list_differences({"seed": old["seed"], "versions": old["versions"]},
                          {"seed": identity.seed, "versions": dict(identity.versions)}),
        *list_differences(fixed[0], fixed[1]),
    ]  # fmt: skip
    only_adds = plan.runs >= counts["runs"] and digest_design(plan, counts["runs"]) == old["design"]
    if not only_adds:
        differences += list_differences(_growing(old["configuration"]), _growing(identity.configuration))
    if differences or not only_adds:
        shown = "; ".join(differences) or "the resolved design differs"
        raise InputError(
            f"{folder}: holds another sweep: {shown}. Only what adds runs after the others may differ (more runs of"
            " sobol, zip or cross, more replicates); choose another --out"
        )


def _without_growing(configuration: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in configuration.items() if key not in GROWING}


def _growing(configuration: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in configuration.items() if key in GROWING}
