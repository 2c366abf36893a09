"""The way in: files and a map, or the map that is proposed for them, become a recording on disk, with its map."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np

from seatsim.importing.assembly import Assembled, assemble, doubt_runs
from seatsim.importing.import_map import FILE, ImportMap, Rig, check_files, read_map, write_map
from seatsim.importing.matching import propose
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import LISTED, DataFile, find_clock
from seatsim.provenance.statement import write_documented
from seatsim.recordings.quality.examination import examine, merge_issues
from seatsim.recordings.quality.issue import Issue
from seatsim.recordings.recording import CHANNELS, CURRENTS, load_recording
from seatsim.recordings.writer import state_header, state_nominal, write_files
from seatsim.scenario.loading import load
from seatsim.schema.content import Form, Unwritten
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.text import name_some

_OWN_FILES = (".yaml", ".yml", ".json", ".md", ".png", ".pdf", ".html")
"""Endings of files that lie beside data and hold none."""


class Import(NamedTuple):
    """What was imported: the map as used, whether it was proposed, files, sentences, doubts, rate in Hz and runs."""

    folder: Path
    map: Unwritten[ImportMap]
    is_proposed: Annotated[bool, Form(key="proposed")]
    paths: Unwritten[list[Path]]
    notes: list[str]
    doubts: list[Issue]
    rate: Annotated[float, Form(key="sample_rate")]
    runs: tuple[str, ...]
    rig: str
    """What was recorded: a seat, or a damper on its bench."""
    channels: dict[str, dict[str, object]]
    """Where each channel was taken from, as `map.yaml` states it."""
    align: Mapping[str, float]
    """How records of several clocks were brought together."""
    names: Annotated[list[str], Form(key="written")]
    """Names of the files that were written."""


def import_files(
    paths: Sequence[Path], folder: Path, map_file: Path | None = None, nominal: str | None = None
) -> Import:
    """Write a recording made of files.

    Without `map_file` the map is proposed from names and units. Where it cannot be used as it is, it is written to the
    folder to be completed, and nothing else is.

    Raises:
        InputError: a file or the map is wrong, the proposal is incomplete, or the data contradict the map.
    """
    stated = read_map(map_file) if map_file else None
    files = [read_file(path, stated.csv if stated else None) for path in _data_files(paths)]
    notes = [f"{file.path.name}: {note}" for file in files for note in file.notes]
    if stated is None:
        used, open_ends = propose(files)
        if open_ends:
            raise _to_be_completed(f"{files[0].path}: {'; '.join(open_ends)}", used, folder)
        clocks = (find_clock(group) for file in files for group in file.groups)
        notes += [said for clock in clocks if clock for said in clock.assumptions] + _say_left_out(files, used)
        try:
            assembled = assemble(files, used)
        except InputError as error:
            raise _to_be_completed(str(error), used, folder) from error
    else:
        used = stated
        check_files(used.runs, [file.path.name for file in files], map_file or Path(FILE))
        assembled = assemble(files, used)
    scenario = _make_nominal(nominal, used.rig, used.channels) if nominal else None
    found = [*assembled.doubts, *([] if scenario else doubt_runs(assembled))]
    doubts = merge_issues(found, len(assembled.runs))
    if scenario:  # the issues that `gap` and `diagnose` will name
        with temporary_folder() as place:
            _write_recording(place, assembled, scenario)
            doubts += examine(load_recording(place)).issues
    paths = _write_recording(folder, assembled, scenario)
    notes += assembled.notes
    used, entries = assembled.map, {name: entry._asdict().items() for name, entry in assembled.map.channels.items()}
    channels = {name: {key: value for key, value in held if value is not None} for name, held in entries.items()}
    runs, names = tuple(assembled.runs), [path.name for path in paths]
    return Import(
        folder, used, stated is None, paths, notes, doubts, assembled.rate, runs, used.rig, channels, used.align, names
    )


def _data_files(paths: Sequence[Path]) -> list[Path]:
    """Return the files, those of a folder in the order of their names."""
    found = []
    for path in paths:
        inside = sorted(each for each in path.iterdir() if each.is_file()) if path.is_dir() else []
        own = [each for each in inside if each.name.startswith(".") or each.name.lower().endswith(_OWN_FILES)]
        found += [each for each in inside if each not in own] if path.is_dir() else [path]
    if not found:
        raise InputError(f"{paths[0]}: holds no data file; give files, or a folder of them")
    return found


def _say_left_out(files: Sequence[DataFile], used: ImportMap) -> list[str]:
    """Return a sentence on the columns that a proposed map does not use, if there are any."""
    groups = [group for file in files for group in file.groups]
    clocks = [used.time, *map(find_clock, groups)]
    taken = used.columns | {clock.column for clock in clocks if clock}
    columns = [signal.name for group in groups for signal in group.signals]
    left = [f"'{name}'" for name in dict.fromkeys(columns) if name not in taken]
    channels = ", ".join(name for name in CHANNELS[used.rig] if name not in used.channels)
    use = f"to use one, state it under channels of the map{f' as one of {channels}' if channels else ''}"
    names = name_some(left, LISTED) if left else ""
    return [f"left out, for want of a channel with such a name: {names}; {use}"] if left else []


def _to_be_completed(problem: str, proposed: ImportMap, folder: Path) -> InputError:
    """Write a proposed map that cannot be used as it is, and return the error that asks to complete it."""
    path = write_map(folder / FILE, proposed)
    return InputError(f"{problem}; the map so far is in {path}: complete it and give it by --map {path}")


def _write_recording(folder: Path, assembled: Assembled, nominal: Mapping[str, object] | None) -> list[Path]:
    """Write tables, nominal scenario, map and header of a recording, all or none."""
    used, rate = assembled.map, assembled.rate
    rows = {name: len(next(iter(table.values()))) for name, table in assembled.runs.items()}
    tables = {name: {"time": np.arange(rows[name]) / rate, **table} for name, table in assembled.runs.items()}
    runs = {name: {"repeat_of": used.repeats[name]} if name in used.repeats else {} for name in tables}
    noise = {name: entry.noise_rms for name, entry in used.channels.items()}
    header = state_header(used.rig, rate, {}, runs, noise)
    header |= {"actuator": used.actuator._asdict()} if used.actuator else {}
    return write_documented(
        folder, lambda part: [*write_files(part, tables, nominal, header, "%.9g"), write_map(part / FILE, used)]
    )


def _make_nominal(scenario: str, rig: Rig, recorded: Collection[str]) -> Mapping[str, object]:
    """Return the content of the nominal scenario of a rig with these recorded channels.

    Where no current was recorded, the scenario's constant one is kept.

    Raises:
        InputError: the scenario is wrong, or states no constant current where none is recorded.
    """
    source = load(scenario)[0].source
    if source is None:
        raise InputError(f"{scenario}: states no rig; give the file of a scenario")
    law: dict[str, object] = {"law": "replay"}
    if rig == "seat" and not any(name in recorded for name in CURRENTS):
        stated = source.data.get("controller")
        law["current"] = stated.get("current") if isinstance(stated, Mapping) else None
        if law["current"] is None:
            problem = "no current was recorded, and the scenario states no constant one; write controller:"
            remedy = "{law: constant, current: 0.0} with the current that flowed"
            raise source.error(("controller",), f"{problem} {remedy}")
    return state_nominal(source.data, rig, law)
