"""An import as files: a recording of section 3 with its map, or a road with an excitation that drives on it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from pathlib import Path

import numpy as np

from seatsim.importing.assembly import DISTANCE, Assembled
from seatsim.importing.import_map import FILE, ImportMap, Rig, write_map
from seatsim.provenance.manifest import write_documented
from seatsim.recordings.recording import CHANNELS
from seatsim.recordings.writer import NOMINAL, state_nominal, write_files
from seatsim.scenario.loading import load
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.files import write_packed, write_text
from seatsim.schema.text import disarm
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import dump

_ROAD, _EXCITATION = "road.csv.gz", "excitation.yaml"
_SPEED = 12.0
"""m/s at which the excitation drives on an imported road until another is stated."""
_CURRENTS = ("current_command", "command_voltage", "coil_current")


def write_recording(folder: Path, assembled: Assembled, nominal: Mapping[str, object] | None) -> list[Path]:
    """Write tables, nominal scenario, map and header of a recording, all or none."""
    return write_documented(folder, lambda part: _write_recording(part, assembled, nominal))


def _write_recording(folder: Path, assembled: Assembled, nominal: Mapping[str, object] | None) -> list[Path]:
    rate = assembled.rate
    tables = {run.name: {"time": np.arange(run.rows) / rate, **run.table} for run in assembled.runs}
    return [*write_files(folder, tables, nominal, _header(assembled), "%.9g"), write_map(folder / FILE, assembled.map)]


def _header(assembled: Assembled) -> dict[str, object]:
    used = assembled.map
    channels: dict[str, dict[str, object]] = {}
    for name, entry in used.channels.items():
        channels[name] = {"unit": CHANNELS[used.rig][name]}
        if entry.noise_rms is not None:
            channels[name]["noise_rms"] = entry.noise_rms
    runs = [{"name": run.name, "file": f"{run.name}.csv.gz"} for run in assembled.runs]
    runs = [run | ({"repeat_of": used.repeats[run["name"]]} if run["name"] in used.repeats else {}) for run in runs]
    header: dict[str, object] = {"rig": used.rig, "sample_rate": assembled.rate, "nominal": NOMINAL, "runs": runs}
    return header | {"channels": channels} | ({"actuator": used.actuator._asdict()} if used.actuator else {})


def write_road(folder: Path, road: Mapping[str, Array], stated: ImportMap) -> list[Path]:
    """Write a road as a table over distance, and a scenario's `excitation` that drives on its middle track."""
    import pandas as pd

    frame = pd.DataFrame({str(disarm(name)): values for name, values in road.items()})
    tracks = [name for name in frame if name != DISTANCE]
    table = {"kind": "table", "path": _ROAD, "distance_column": DISTANCE}
    excitation = {"excitation": {**table, "column": tracks[len(tracks) // 2], "speed": _SPEED}}
    write_table = partial(frame.to_csv, mode="wb", index=False, float_format="%.9g")
    return write_documented(
        folder,
        lambda part: [
            write_packed(part / _ROAD, write_table),
            write_map(part / FILE, stated),
            write_text(part / _EXCITATION, dump(excitation)),
        ],
    )


def make_nominal(scenario: str, rig: Rig, recorded: Collection[str]) -> Mapping[str, object]:
    """Return the content of the nominal scenario of a rig with these recorded channels.

    Where no current was recorded, the scenario's constant one is kept.

    Raises:
        InputError: the scenario is wrong, or states no constant current where none is recorded.
    """
    source = load(scenario)[0].source
    if source is None:
        raise InputError(f"{scenario}: states no rig; give the file of a scenario")
    return state_nominal(source.data, rig, {} if rig == "damper_bench" else _law(source, recorded))


def _law(source: Source, recorded: Collection[str]) -> dict[str, object]:
    if any(name in recorded for name in _CURRENTS):
        return {"law": "replay"}
    law = source.data.get("controller")
    current = law.get("current") if isinstance(law, Mapping) else None
    if current is None:
        problem = "no current was recorded, and the scenario states no constant one"
        raise source.error(
            ("controller",),
            f"{problem}; write controller: {{law: constant, current: 0.0}} with the current that flowed",
        )
    return {"law": "replay", "current": current}
