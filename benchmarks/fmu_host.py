"""Hosts in C for the units that are exported: built against the headers of the standard, fed with samples."""

from __future__ import annotations

import subprocess
import zipfile
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from seatsim.exchange.block import Block, list_variables
from seatsim.exchange.export import find_compiler, write_fmu
from seatsim.schema.arrays import Array

HERE = Path(__file__).parent


def headers() -> Path:
    """Return the folder of the headers of the standard."""
    spec = find_spec("fmpy")
    assert spec is not None and spec.origin is not None
    return Path(spec.origin).parent / "c-code"


def build_host(version: int, folder: Path) -> Path:
    """Build the host of a version, where it is not there, and return its path."""
    host = folder / f"host{version}"
    if host.exists():
        return host
    source = HERE / f"fmu_host{version}.c"
    command = [find_compiler(), "-std=gnu99", "-Wall", "-Werror", "-O2", f"-I{headers()}", "-o", str(host), str(source)]
    subprocess.run([*command, "-ldl"], check=True, timeout=60)
    return host


def run_unit(block: Block, version: int, inputs: Mapping[str, Array], folder: Path, step: float) -> Array:
    """Export a block, run it in a host with samples of its inputs, shape (N,) each.

    Returns its outputs, shape (N + 1, outputs): at rest, then after each step.
    """
    path = folder / f"unit{version}.fmu"
    write_fmu(block, version, path)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder / f"unit{version}")
    library = next(path for path in (folder / f"unit{version}" / "binaries").rglob("*") if path.is_file())
    text = (folder / f"unit{version}" / "modelDescription.xml").read_text()
    token = text.partition("{")[2].partition("}")[0]
    names = [v.name for v in list_variables(block)]
    outputs = [v.name for v in list_variables(block) if v.causality == "output"]
    numbers = np.array([names.index(name) for name in [*inputs, *outputs]], dtype=np.uint32)
    samples = np.column_stack([np.asarray(values, dtype=float) for values in inputs.values()])
    sizes = [str(len(samples)), str(len(inputs)), str(len(outputs))]
    command = [str(build_host(version, folder)), str(library), f"{{{token}}}", repr(step), *sizes]
    fed = numbers.tobytes() + np.ascontiguousarray(samples).tobytes()
    done = subprocess.run(command, input=fed, capture_output=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr.decode()
    # the last number is the time that the host took
    return np.frombuffer(done.stdout)[:-1].reshape(len(samples) + 1, len(outputs))
