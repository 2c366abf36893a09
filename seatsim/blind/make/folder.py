"""Recording folders of drawn cases, in the contract's format, with nothing in them that tells the label."""

from __future__ import annotations

import gzip
import io
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator
from ruamel.yaml import YAML

from seatsim.blind.make.case import CHANNELS, RunPlan, Setting
from seatsim.blind.truth.rig import RATE
from seatsim.blind.truth.slots import Array

UNITS = {
    "floor_acceleration": "m/s^2", "frame_acceleration": "m/s^2", "driver_acceleration": "m/s^2",
    "suspension_displacement": "m", "damper_force": "N", "current_command": "A", "coil_current": "A",
    "damper_temperature": "degC",
}  # fmt: skip
DIGITS = {"suspension_displacement": 6, "damper_force": 1, "damper_temperature": 2}
TOLERANCE = 0.02
EPOCH = 1_600_000_000
"""Time stamp of every file, s."""


def nominal_scenario(setting: Setting) -> dict[str, Any]:
    """Return the scenario as the owner believes it."""
    n = setting.nominal
    bingham = n["is_bingham"] == 1.0
    letter = "fc" if bingham else "alpha"
    names = ("f0", "v_ref") if bingham else ("k0", "x0", "f0", "A", "beta", "gamma")
    parameters: dict[str, Any] = {"c_a": n["c_a"], "c_b": n["c_b"], f"{letter}_a": n["y_a"], f"{letter}_b": n["y_b"]}
    parameters |= {name: n[name] for name in names}
    if not bingham:
        parameters["n"] = int(n["n"])
    return {
        "plant": {
            "frame_mass": n["ms"], "driver_mass": n["m"], "suspension_stiffness": n["kf"], 
            "suspension_damping": n["cf"], "cushion_stiffness": n["kc"], "cushion_damping": n["cc"],
        },
        "damper": {"model": "bingham" if bingham else "bouc_wen", "parameters": parameters},
        "actuator": {"rate": n["rate"], "max_current": n["i_max"]},
        "temperature": 20.0,
        "controller": {"law": "replay"},
        "excitation": {"kind": "recording"},
    }  # fmt: skip


def header(setting: Setting, runs: list[RunPlan]) -> dict[str, Any]:
    """Return `recording.yaml`."""
    channels: dict[str, dict[str, Any]] = {}
    for name in CHANNELS:
        if name in setting.channels:
            noise = {"noise_rms": setting.noise[name]} if name in setting.noise else {}
            channels[name] = {"unit": UNITS[name]} | noise
    entries = [
        {"name": run.name, "file": f"{run.name}.csv.gz"} | ({"repeat_of": run.repeat_of} if run.repeat_of else {})
        for run in runs
    ]
    return {
        "rig": "seat", "sample_rate": RATE, "parameter_tolerance": TOLERANCE, "nominal": "nominal.yaml",
        "runs": entries, "channels": channels,
    }  # fmt: skip


def noisy(setting: Setting, shown: dict[str, Array], rng: Generator) -> dict[str, Array]:
    """Return the recorded channels with white noise of the stated rms."""
    out = {}
    for name in CHANNELS:
        noise = rng.standard_normal(shown[name].size)
        if name in setting.channels:
            out[name] = shown[name] + setting.noise.get(name, 0.0) * noise
    return out


def table_bytes(channels: dict[str, Array]) -> bytes:
    """Return a run as a gzipped CSV whose bytes depend on nothing but the numbers."""
    rows = next(iter(channels.values())).size
    columns = [np.char.mod("%.3f", np.arange(rows) / RATE)]
    columns += [np.char.mod(f"%.{DIGITS.get(name, 4)}f", values) for name, values in channels.items()]
    lines = [",".join(("time", *channels))] + [",".join(row) for row in zip(*columns, strict=True)]
    packed = io.BytesIO()
    with gzip.GzipFile(fileobj=packed, mode="wb", mtime=0, compresslevel=6) as stream:
        stream.write(("\n".join(lines) + "\n").encode())
    return packed.getvalue()


def yaml_bytes(value: dict[str, Any]) -> bytes:
    """Return a mapping as YAML."""
    stream = io.BytesIO()
    yaml = YAML()
    yaml.default_flow_style = False
    yaml.dump(value, stream)
    return stream.getvalue()


def recording_files(
    setting: Setting, shown: list[dict[str, Array]], rng: Generator, runs: list[int]
) -> dict[str, bytes]:
    """Return the files of a recording folder that holds these runs."""
    plans = [setting.runs[k] for k in runs]
    files = {
        "recording.yaml": yaml_bytes(header(setting, plans)),
        "nominal.yaml": yaml_bytes(nominal_scenario(setting)),
    }
    for k, plan in zip(runs, plans, strict=True):
        files[f"{plan.name}.csv.gz"] = table_bytes(noisy(setting, shown[k], rng))
    return files


def write_files(folder: Path, files: dict[str, bytes]) -> None:
    """Write a folder whole: under another name first, then renamed; its times tell nothing of how long a draw took."""
    part = folder.with_name(f".{folder.name}.part")
    part.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (part / name).write_bytes(content)
        os.utime(part / name, (EPOCH, EPOCH))
    os.utime(part, (EPOCH, EPOCH))
    part.replace(folder)
