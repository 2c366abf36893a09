"""What a recording holds, or a file by its map: channels, what `gap` and `diagnose` say, noise that is not stated."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from seatsim.importing.assembly import assemble, doubt_runs
from seatsim.importing.doubts import doubt_channel
from seatsim.importing.import_map import read_map
from seatsim.importing.inspection import ChannelSummary, Inspection, summarise
from seatsim.importing.names import quantity_of
from seatsim.importing.readers.reading import read_file
from seatsim.importing.signals import Signal
from seatsim.recordings.quality.damage import QUIET
from seatsim.recordings.quality.examination import examine, merge_issues
from seatsim.recordings.quality.issue import Issue, place_in_run
from seatsim.recordings.quality.relations import doubt_relations
from seatsim.recordings.quality.sensors import list_unrepeated, measure_unrepeated
from seatsim.recordings.recording import CHANNELS, COMMANDS, Recording, load_recording
from seatsim.schema.arrays import Array


def inspect_recording(folder: Path) -> Inspection:
    """Return what a recording holds.

    Raises:
        InputError: its header, a table or its nominal scenario cannot be read.
    """
    recording = load_recording(folder)
    rate = recording.header.sample_rate
    channels: dict[str, list[ChannelSummary]] = {}
    doubts: list[Issue] = []
    for run in recording.runs:
        table = recording.table(run)
        channels[run] = _summarise_table(table, CHANNELS[recording.header.rig], rate)
        found = [
            issue for name, values in table.items() for issue in doubt_channel(name, values, rate, quantity_of(name))
        ]
        found += [] if recording.nominal_file.exists() else doubt_relations(table, rate)
        doubts += place_in_run(run, found)
    doubts = merge_issues(doubts, len(recording.runs))
    doubts += _offered(recording, channels, doubts)
    if recording.nominal_file.exists():
        doubts += examine(recording).issues
    else:
        text = f"{recording.header.nominal} is missing; signs, units and delays are not compared with a simulation"
        doubts.append(Issue("warning", "nominal", text))
    return Inspection(str(folder), "recording", channels, doubts)


def inspect_mapped(path: Path, map_file: Path) -> Inspection:
    """Return what import would make of a file by a map: channels in SI units, with what is left to doubt.

    Raises:
        InputError: the file or the map is wrong.
    """
    stated = read_map(map_file)
    file = read_file(path, stated.csv)
    assembled = assemble([file], dataclasses.replace(stated, runs={}))
    units = CHANNELS[stated.rig]
    channels = {run.name: _summarise_table(run.table, units, assembled.rate) for run in assembled.runs}
    notes = [Issue("note", "mapped", note) for note in (*file.notes, *assembled.notes)]
    doubts = merge_issues([*assembled.doubts, *doubt_runs(assembled)], len(assembled.runs))
    return Inspection(str(path), f"{file.format} by {map_file.name}", channels, [*notes, *doubts])


def _summarise_table(table: Mapping[str, Array], units: Mapping[str, str], rate: float) -> list[ChannelSummary]:
    return [summarise(Signal(name, units[name], values), units[name], name, rate) for name, values in table.items()]


def _offered(
    recording: Recording, channels: dict[str, list[ChannelSummary]], doubts: Sequence[Issue]
) -> Iterator[Issue]:
    """Yield the noise of each measured channel that states none: of its floor, or of repeats, which show all of it."""
    tables = {run: recording.table(run) for run in recording.runs}
    for name, entry in recording.channels.items():
        if entry.noise_rms > 0.0 or name in COMMANDS:
            continue
        repeated = measure_unrepeated(list_unrepeated(recording.runs, tables, name))
        noises = (each.noise for held in channels.values() for each in held if each.name == name)
        floor = min(filter(None, noises), default=0.0)
        is_quiet = any(issue.channel == name and issue.kind in QUIET for issue in doubts)
        if repeated > 0.0:
            differ = f"differ by noise_rms: {repeated:.2g}, with {floor:.2g} at high frequencies"
            yield Issue("note", "noise", f"{name}: states no noise; repeats of one excitation {differ}", name)
        elif floor and not is_quiet:
            text = f"states no noise; its floor at high frequencies shows noise_rms: {floor:.2g}"
            yield Issue("note", "noise", f"{name}: {text}", name)
