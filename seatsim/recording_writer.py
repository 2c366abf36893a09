"""A simulated result written as a recording of a rig."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from ruamel.yaml import YAML

from seatsim.errors import InputError, nearest
from seatsim.files import write_whole
from seatsim.recording import SEAT_CHANNELS
from seatsim.result import Result


def save_recording(result: Result, folder: str | Path, channels: Sequence[str], tolerance: float = 0.02) -> Path:
    """Write the runs of one simulated seat as a recording without noise, one row a step, and return its folder.

    The nominal scenario is the first run's, driven by `law: replay` and `kind: recording`.

    Raises:
        InputError: a channel is none that a seat recording has.
    """
    folder = Path(folder)
    for name in channels:
        if name not in SEAT_CHANNELS:
            raise InputError(
                f"'{name}' is no channel of a seat{nearest(name, SEAT_CHANNELS)}: {', '.join(SEAT_CHANNELS)}"
            )
    names = [f"run-{index + 1}" for index in range(len(result.runs))]
    first = result.runs[0]
    for name, run in zip(names, result.runs, strict=True):
        frame = pd.DataFrame({key: np.asarray(run[key]) for key in ("time", *channels)})
        write_whole(folder / f"{name}.csv.gz", partial(frame.to_csv, index=False, float_format="%.7g"))
    values = first.scenario.source.data if first.scenario.source else {}
    kept = ("plant", "damper", "actuator", "effects", "solver")
    nominal = {key: values[key] for key in kept if key in values}
    nominal |= {"temperature": first.scenario.temperature, "controller": {"law": "replay"}}
    nominal |= {"excitation": {"kind": "recording"}}
    header = {
        "rig": "seat",
        "sample_rate": 1.0 / first.history.step,
        "parameter_tolerance": tolerance,
        "nominal": "nominal.yaml",
        "runs": [{"name": name, "file": f"{name}.csv.gz"} for name in names],
        "channels": {name: {"unit": SEAT_CHANNELS[name]} for name in channels},
    }
    for file, content in (("nominal.yaml", nominal), ("recording.yaml", header)):
        write_whole(folder / file, partial(YAML(typ="safe").dump, content))
    return folder
