"""What makes two sweeps the same: configuration, resolved design, versions, seed; and what sets them apart, by name."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from seatsim.provenance.versions import list_versions
from seatsim.schema.content import plain
from seatsim.schema.modules import used_files
from seatsim.sweeps.definition import SweepDefinition
from seatsim.sweeps.plan import Plan

LIBRARIES = ("numpy", "scipy", "numba", "pyarrow")
"""Libraries that a figure, or the bytes of a part, may hang on."""
GROWING = ("runs", "replicates", "vary", "table")
"""Parts of a configuration that may differ where the difference only adds runs."""


class Identity(NamedTuple):
    """What a sweep is: `digest` over all the rest. `configuration` is what its files state, without the limits."""

    digest: str
    seed: int
    versions: Mapping[str, str]
    configuration: Mapping[str, object]
    runs: int
    design: str


def identify_sweep(definition: SweepDefinition, plan: Plan) -> Identity:
    """Return the identity of a sweep."""
    stated = {key: value for key, value in definition.source.data.items() if key not in ("scenario", "seed", "limits")}
    configuration = {"scenario": definition.scenario.data, **stated, "files": dict(_digest_files(plan))}
    versions, design = list_versions(LIBRARIES, used_files()), digest_design(plan, plan.runs)
    whole = [configuration, design, versions, definition.seed]
    return Identity(_digest(whole), definition.seed, versions, _read_back(configuration), plan.runs, design)


def digest_design(plan: Plan, runs: int) -> str:
    """Return a hash over the values of the first runs of a sweep."""
    state = hashlib.sha256()
    for run in range(runs):
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


def _digest(value: object) -> str:
    return hashlib.sha256(_encode(value)).hexdigest()


def _encode(value: object) -> bytes:
    return json.dumps(plain(value), sort_keys=True, default=str).encode()


def _read_back(value: object) -> Mapping[str, object]:
    """Return a mapping as it will be read from JSON, so that it equals what was written."""
    found: Mapping[str, object] = json.loads(_encode(value))
    return found


def _shown(value: object) -> str:
    text = "absent" if value is None else json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
