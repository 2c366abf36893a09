"""A simulated result written as a recording of a rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd

from seatsim.recordings.channel_units import SEAT_CHANNELS
from seatsim.recordings.header import USUAL, Tolerances
from seatsim.scenario.numbers import PARAMETERS, TEMPERATURE, list_numbers
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.files import write_packed, write_text, write_together
from seatsim.schema.yaml_text import dump
from seatsim.simulation.result import Result, Run

WITHOUT_NOISE: Mapping[str, float] = MappingProxyType({})


def save_recording(
    result: Result, folder: str | Path, channels: Sequence[str], tolerance: Tolerances = USUAL,
    model_error: float | None = None, noise: Mapping[str, float] = WITHOUT_NOISE,
) -> Path:  # fmt: skip
    """Write the runs of one simulated seat as a recording, one row a step, and return its folder.

    The nominal scenario is the first run's, driven by `law: replay` and `kind: recording`. Parameters and
    temperature of another run that differ from it stand in that run's entry under `set`. White `noise` of an RMS by
    channel, in the channel's unit, is added and stated; it is drawn from the first run's seed.

    Raises:
        InputError: a channel is none that a seat recording has.
    """
    folder = Path(folder)
    for name in channels:
        if name not in SEAT_CHANNELS:
            raise InputError(
                f"'{name}' is no channel of a seat{nearest(name, SEAT_CHANNELS)}: {', '.join(SEAT_CHANNELS)}"
            )
    first = result.runs[0]
    if any(run.history.step != first.history.step for run in result.runs):
        raise InputError("the runs differ in solver.step; a recording has one sample rate")
    files = {f"run-{index + 1}": run for index, run in enumerate(result.runs)}
    nominal = _nominal(first, {"current_command", "coil_current"} & set(channels))
    header = {
        "rig": "seat",
        "sample_rate": 1.0 / first.history.step,
        "parameter_tolerance": dict(tolerance) if isinstance(tolerance, Mapping) else tolerance,
        "nominal": "nominal.yaml",
        "runs": [{"name": name, "file": f"{name}.csv.gz"} | _changes(first, run) for name, run in files.items()],
        "channels": {
            name: {"unit": SEAT_CHANNELS[name]} | ({"noise_rms": noise[name]} if name in noise else {})
            for name in channels
        },
    }
    if model_error is not None:
        header["model_error"] = model_error
    rng = np.random.default_rng(first.scenario.seed)
    tables = {
        f"{name}.csv.gz": pd.DataFrame(
            {"time": np.asarray(run["time"])}
            | {key: run[key] + noise.get(key, 0.0) * rng.standard_normal(len(run[key])) for key in channels}
        )
        for name, run in files.items()
    }
    scenarios = {"nominal.yaml": nominal, "recording.yaml": header}
    write_together(
        folder,
        lambda part: [
            *(write_packed(part / name, partial(table.to_csv, mode="wb", index=False, float_format="%.7g"))
              for name, table in tables.items()),
            *(write_text(part / name, dump(content)) for name, content in scenarios.items()),
        ],
    )  # fmt: skip
    return folder


def _changes(first: Run, run: Run) -> dict[str, dict[str, float]]:
    """Return the entry `set` of a run: what of its rig differs from the first run's; nothing where nothing does."""
    nominal, own = list_numbers(first.scenario), list_numbers(run.scenario)
    if type(first.scenario.damper.record) is not type(run.scenario.damper.record):
        raise InputError(f"{run.scenario.title}: has another damper model; a recording has one nominal scenario")
    changed = {
        key: value for key, value in own.items()
        if key.startswith((*PARAMETERS, TEMPERATURE)) and value != nominal.get(key)
    }  # fmt: skip
    return {"set": changed} if changed else {}


def _nominal(run: Run, recorded: set[str]) -> dict[str, object]:
    """Return the content of the nominal scenario; a current that is not `recorded` must be constant."""
    if run.scenario.source is None:
        raise InputError(f"{run.scenario.name}: only the result of a scenario file can become a recording")
    values = run.scenario.source.data
    law: dict[str, object] = {"law": "replay"}
    if not recorded:
        commands = run["current_command"]
        if np.ptp(commands) > 0.0:
            raise InputError("a current that changes must be recorded: add the channel current_command or coil_current")
        law["current"] = float(commands[0])
    kept = ("plant", "driver", "damper", "actuator", "temperature", "effects", "solver")
    nominal = {key: values[key] for key in kept if key in values}
    return nominal | {"controller": law, "excitation": {"kind": "recording"}}
