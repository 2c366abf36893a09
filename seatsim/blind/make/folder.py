"""Recording folders of drawn cases, in the contract's format, with nothing in them that reveals the label."""

import io
import os
import struct
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from seatsim.blind.truth.excitation import colour_noise
from seatsim.blind.truth.experiment import CHANNELS, Experiment, Readings, RunPlan
from seatsim.schema.fields import read_packaged
from seatsim.schema.files import write_together
from seatsim.schema.yaml_text import dump

_EPOCH = 1_600_000_000
"""Time stamp of every file, s: the true time would reveal how long its case took to draw."""
_GZIP = b"\x1f\x8b\x08" + bytes(6) + b"\xff"
"""Head of a gzip file without time and system."""
_BLOCK = 0xFFFF
"""Most bytes of a stored block."""
_SYMBOLS = read_packaged(Path(__file__).with_name("nominal.yaml"), dict[str, dict[str, str]])
"""Symbols of the true rig by the names of the nominal's plant, and of those of each damper's parameters."""


def nominal_scenario(experiment: Experiment) -> dict[str, object]:
    """Return the nominal scenario, which the owner assumes, under the contract's keys."""
    n, model = experiment.nominal, "bingham" if experiment.is_bingham else "bouc_wen"
    parameters = {name: n[symbol] for name, symbol in _SYMBOLS[model].items()}
    return {
        "plant": {name: n[symbol] for name, symbol in _SYMBOLS["plant"].items() if symbol in n},
        "damper": {"model": model, "parameters": parameters | ({} if experiment.is_bingham else {"n": int(n["n"])})},
        "actuator": {"rate": n["rate"], "max_current": n["i_max"]},
        "temperature": 20.0,
        "controller": {"law": "replay"},
        "excitation": {"kind": "recording"},
    }


def recording_header(experiment: Experiment, runs: Sequence[RunPlan]) -> dict[str, object]:
    """Return the content of `recording.yaml`."""
    noise = {name: {"noise_rms": rms} for name, rms in experiment.noise.items()}
    recorded = [name for name in CHANNELS if name in experiment.channels]
    repeats = {run.name: {"repeat_of": run.repeat_of} for run in runs if run.repeat_of}
    entries = [{"name": run.name, "file": f"{run.name}.csv.gz"} | repeats.get(run.name, {}) for run in runs]
    return {
        "rig": "seat",
        "sample_rate": experiment.sample_rate,
        "parameter_tolerance": experiment.tolerance,
        "nominal": "nominal.yaml",
        "runs": entries,
        "channels": {name: {"unit": CHANNELS[name].unit} | noise.get(name, {}) for name in recorded},
    }


def add_noise(experiment: Experiment, readings: Readings, rng: Generator) -> Readings:
    """Return the recorded channels with noise of the stated rms, white or of the channel's colour.

    Channels that are not recorded take their numbers of the generator too, so that the others' noise is the same.
    """
    noisy = {}
    for name in CHANNELS:
        noise = rng.standard_normal(readings[name].size)
        if name in experiment.channels:
            colour = experiment.colours.get(name)
            unit = noise if colour is None else colour_noise(noise, colour, experiment.sample_rate)
            noisy[name] = readings[name] + experiment.noise.get(name, 0.0) * unit
    return noisy


def encode_table(columns: Readings, formats: Sequence[str]) -> bytes:
    """Return a run as a gzipped CSV whose bytes depend on nothing but the numbers; a format for each column."""
    text = io.StringIO()
    np.savetxt(text, np.column_stack(list(columns.values())), list(formats), ",", header=",".join(columns), comments="")
    return _store(text.getvalue().encode())


def _store(content: bytes) -> bytes:
    """Return a gzip file (RFC 1952) of stored blocks: what is compressed depends on the library that does it."""
    starts = range(0, len(content), _BLOCK)
    blocks = [content[start : start + _BLOCK] for start in starts]
    packed = [
        struct.pack("<BHH", start + _BLOCK >= len(content), len(block), len(block) ^ _BLOCK) + block
        for start, block in zip(starts, blocks, strict=True)
    ]
    return b"".join([_GZIP, *packed, struct.pack("<II", zlib.crc32(content), len(content))])


def encode_yaml(value: Mapping[str, object]) -> bytes:
    """Return a mapping as YAML."""
    return dump(value, line_each=True).encode()


def encode_recording(
    experiment: Experiment, readings: Sequence[Readings], rng: Generator, runs: Sequence[int]
) -> dict[str, bytes]:
    """Return the files of a recording folder that holds these runs, by name; the noise is drawn run by run."""
    plans = [experiment.runs[k] for k in runs]
    files = {"recording.yaml": encode_yaml(recording_header(experiment, plans))}
    files |= {"nominal.yaml": encode_yaml(nominal_scenario(experiment))}
    rate = experiment.sample_rate
    for k, plan in zip(runs, plans, strict=True):
        noisy = add_noise(experiment, readings[k], rng)
        time = np.arange(next(iter(noisy.values())).size) / rate
        formats = ["%.3f" if 1000.0 % rate == 0.0 else "%.9f", *(f"%.{CHANNELS[name].digits}f" for name in noisy)]
        files[f"{plan.name}.csv.gz"] = encode_table({"time": time, **noisy}, formats)
    return files


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write a folder, whole or not at all; its time stamps do not reveal how long a draw took.

    Raises:
        InputError: it cannot be written. OutputError: the disk is full.
    """

    def fill(part: Path) -> list[Path]:
        for name, content in files.items():
            (part / name).write_bytes(content)
            os.utime(part / name, (_EPOCH, _EPOCH))
        os.utime(part, (_EPOCH, _EPOCH))
        return [part / name for name in files]

    write_together(folder, fill)
