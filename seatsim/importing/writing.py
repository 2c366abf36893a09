"""An import as files: a recording of section 3 with its map, or a road with an excitation that drives on it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from pathlib import Path

import numpy as np

from seatsim.importing.assembly import DISTANCE, Assembled
from seatsim.importing.import_map import FILE, ImportMap, Rig, write_map
from seatsim.provenance.manifest import write_documented
from seatsim.recordings.channel_units import CHANNELS
from seatsim.scenario.loading import load
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.files import write_packed, write_text
from seatsim.schema.text import disarm
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import dump

HEADER = "recording.yaml"
ROAD, EXCITATION = "road.csv.gz", "excitation.yaml"
SPEED = 12.0
"""m/s at which the excitation drives on an imported road until another is stated."""
NOMINAL = "nominal.yaml"
KEPT = {
    "seat": ("plant", "driver", "damper", "actuator", "temperature", "effects", "solver"),
    "damper_bench": ("damper", "actuator", "temperature", "effects"),
}
"""Sections of a scenario that state its rig."""
CURRENTS = ("current_command", "command_voltage", "coil_current")


def write_recording(folder: Path, assembled: Assembled, nominal: Mapping[str, object] | None) -> list[Path]:
    """Write tables, nominal scenario, map and header of a recording, all or none."""
    return write_documented(folder, lambda part: _write_recording(part, assembled, nominal))


def _write_recording(folder: Path, assembled: Assembled, nominal: Mapping[str, object] | None) -> list[Path]:
    paths = [_write_table(folder / f"{run.name}.csv.gz", run.table, assembled.rate) for run in assembled.runs]
    if nominal is not None:
        paths.append(_write_yaml(folder / NOMINAL, nominal))
    paths.append(write_map(folder / FILE, assembled.map))
    return [*paths, _write_yaml(folder / HEADER, _header(assembled))]


def _header(assembled: Assembled) -> dict[str, object]:
    used = assembled.map
    channels: dict[str, dict[str, object]] = {}
    for name, entry in used.channels.items():
        channels[name] = {"unit": CHANNELS[used.rig][name]}
        if entry.noise_rms is not None:
            channels[name]["noise_rms"] = entry.noise_rms
    header: dict[str, object] = {
        "rig": used.rig, "sample_rate": assembled.rate, "nominal": NOMINAL,
        "runs": [{"name": run.name, "file": f"{run.name}.csv.gz", **_repeat(run.name, used)} for run in assembled.runs],
        "channels": channels,
    }  # fmt: skip
    return header | ({"actuator": {"gain": used.actuator.gain}} if used.actuator else {})


def _repeat(run: str, used: ImportMap) -> dict[str, str]:
    return {"repeat_of": used.repeats[run]} if run in used.repeats else {}


def _write_table(path: Path, table: Mapping[str, Array], rate: float) -> Path:
    import pandas as pd

    rows = len(next(iter(table.values())))
    frame = pd.DataFrame({"time": np.arange(rows) / rate, **table})
    return write_packed(path, partial(frame.to_csv, mode="wb", index=False, float_format="%.9g"), level=3)


def write_road(folder: Path, road: Mapping[str, Array], stated: ImportMap) -> list[Path]:
    """Write a road as a table over distance, and a scenario's `excitation` that drives on its middle track."""
    import pandas as pd

    frame = pd.DataFrame({str(disarm(name)): values for name, values in road.items()})
    tracks = [name for name in frame if name != DISTANCE]
    excitation = {"excitation": {"kind": "table", "path": ROAD, "distance_column": DISTANCE,
                                 "column": tracks[len(tracks) // 2], "speed": SPEED}}  # fmt: skip
    write_table = partial(frame.to_csv, mode="wb", index=False, float_format="%.9g")
    return write_documented(
        folder,
        lambda part: [
            write_packed(part / ROAD, write_table),
            write_map(part / FILE, stated),
            _write_yaml(part / EXCITATION, excitation),
        ],
    )


def _write_yaml(path: Path, content: Mapping[str, object]) -> Path:
    return write_text(path, dump(content))


def make_nominal(scenario: str, rig: Rig, recorded: Collection[str]) -> Mapping[str, object]:
    """Return the content of the nominal scenario of a rig with these recorded channels.

    Where no current was recorded, the scenario's constant one is kept.

    Raises:
        InputError: the scenario is wrong, or states no constant current where none is recorded.
    """
    source = load(scenario)[0].source
    if source is None:
        raise InputError(f"{scenario}: states no rig; give the file of a scenario")
    nominal = {key: source.data[key] for key in KEPT[rig] if key in source.data}
    if rig == "damper_bench":
        return nominal
    return nominal | {"controller": _law(source, recorded), "excitation": {"kind": "recording"}}


def _law(source: Source, recorded: Collection[str]) -> dict[str, object]:
    if any(name in recorded for name in CURRENTS):
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
