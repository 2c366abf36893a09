"""A simulated result written as a recording of a rig."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd

from seatsim.recordings.header import USUAL, Tolerances
from seatsim.recordings.recording import CHANNELS, CURRENTS, HEADER, SEAT_CHANNELS
from seatsim.scenario.numbers import PARAMETERS, TEMPERATURE, list_numbers
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.files import write_packed, write_text, write_together
from seatsim.schema.yaml_text import dump
from seatsim.simulation.result import Result, Run

_NOMINAL = "nominal.yaml"
_OF_DAMPER = ("damper", "actuator", "temperature", "effects")
_RIG = ("plant", "driver", *_OF_DAMPER, "solver")
"""Sections of a scenario that state its rig; on a bench those of the damper alone."""
_WITHOUT_NOISE: Mapping[str, float] = MappingProxyType({})


def save_recording(
    result: Result,
    folder: str | Path,
    channels: Sequence[str],
    tolerance: Tolerances = USUAL,
    model_error: float | None = None,
    noise: Mapping[str, float] = _WITHOUT_NOISE,
) -> Path:
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
            problem = f"'{name}' is no channel of a seat{nearest(name, SEAT_CHANNELS)}: {', '.join(SEAT_CHANNELS)}"
            raise InputError(problem)
    first = result.runs[0]
    if any(run.history.step != first.history.step for run in result.runs):
        raise InputError("the runs differ in solver.step; a recording has one sample rate")
    files = {f"run-{index + 1}": run for index, run in enumerate(result.runs)}
    nominal = _nominal(first, not set(CURRENTS).isdisjoint(channels))
    stated = {"parameter_tolerance": dict(tolerance) if isinstance(tolerance, Mapping) else tolerance}
    runs = {name: _changes(first, run) for name, run in files.items()}
    header = state_header("seat", 1.0 / first.history.step, stated, runs, {name: noise.get(name) for name in channels})
    if model_error is not None:
        header["model_error"] = model_error
    rng = np.random.default_rng(first.scenario.seed)
    tables = {
        name: {"time": np.asarray(run["time"])}
        | {key: run[key] + noise.get(key, 0.0) * rng.standard_normal(len(run[key])) for key in channels}
        for name, run in files.items()
    }
    write_together(folder, lambda part: write_files(part, tables, nominal, header, "%.7g"))
    return folder


def state_header(
    rig: str,
    rate: float,
    stated: Mapping[str, object],
    runs: Mapping[str, Mapping[str, object]],
    noise: Mapping[str, float | None],
) -> dict[str, object]:
    """Return the content of `recording.yaml`.

    `stated` are further keys at its top, `runs` those of each run by its name; `noise` has an RMS for every channel,
    None where none is stated.
    """
    named = [{"name": name, "file": f"{name}.csv.gz"} | dict(more) for name, more in runs.items()]
    channels = {
        name: {"unit": CHANNELS[rig][name]} | ({} if rms is None else {"noise_rms": rms}) for name, rms in noise.items()
    }
    top = {"rig": rig, "sample_rate": rate, **stated, "nominal": _NOMINAL}
    return {**top, "runs": named, "channels": channels}


def write_files(
    folder: Path,
    tables: Mapping[str, Mapping[str, Array]],
    nominal: Mapping[str, object] | None,
    header: Mapping[str, object],
    digits: str,
) -> list[Path]:
    """Write the table of each run, the nominal scenario if there is one, and the header of a recording."""
    frames = {name: pd.DataFrame(dict(table)) for name, table in tables.items()}
    write = {name: partial(each.to_csv, mode="wb", index=False, float_format=digits) for name, each in frames.items()}
    paths = [write_packed(folder / f"{name}.csv.gz", each, level=3) for name, each in write.items()]
    texts = ({} if nominal is None else {_NOMINAL: nominal}) | {HEADER: header}
    return [*paths, *(write_text(folder / name, dump(content)) for name, content in texts.items())]


def state_nominal(content: Mapping[str, object], rig: str, law: Mapping[str, object]) -> dict[str, object]:
    """Return the nominal scenario of a recording: what of a scenario's content states the rig, driven by the record."""
    stated = {key: content[key] for key in _RIG if key in content}
    if rig == "damper_bench":
        return {key: value for key, value in stated.items() if key in _OF_DAMPER}
    return stated | {"controller": law, "excitation": {"kind": "recording"}}


def _changes(first: Run, run: Run) -> dict[str, dict[str, float]]:
    """Return the entry `set` of a run: what of its rig differs from the first run's; nothing where nothing does."""
    nominal, own = list_numbers(first.scenario), list_numbers(run.scenario)
    if type(first.scenario.damper.record) is not type(run.scenario.damper.record):
        raise InputError(f"{run.scenario.title}: has another damper model; a recording has one nominal scenario")
    ours = {key: value for key, value in own.items() if key.startswith((*PARAMETERS, TEMPERATURE))}
    changed = {key: value for key, value in ours.items() if value != nominal.get(key)}
    return {"set": changed} if changed else {}


def _nominal(run: Run, is_current_recorded: bool) -> dict[str, object]:
    """Return the content of the nominal scenario; a current that is not recorded must be constant."""
    if run.scenario.source is None:
        raise InputError(f"{run.scenario.name}: only the result of a scenario file can become a recording")
    values = run.scenario.source.data
    law: dict[str, object] = {"law": "replay"}
    if not is_current_recorded:
        commands = run["current_command"]
        if np.ptp(commands) > 0.0:
            raise InputError("a current that changes must be recorded: add the channel current_command or coil_current")
        law["current"] = float(commands[0])
    return state_nominal(values, "seat", law)
