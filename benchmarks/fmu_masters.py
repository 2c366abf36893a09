"""Exported units in co-simulation programs of others, beside a host in C (`fmu_host`).

    pip install ecospy tbb libcosimpy
    python benchmarks/fmu_masters.py [--seconds 10]

ecos reads units by fmi4c, libcosim by the FMI Library of Modelon; both come without headers or code of FMPy. Printed is
the greatest difference of an output over its greatest value. A program that is not installed is named and left out.
"""

from __future__ import annotations

import argparse
import ctypes
import sys
import tempfile
from collections.abc import Callable, Mapping
from importlib.metadata import version as version_of
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from fmu_host import run_unit

from seatsim.exchange.block import Block, list_variables
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig_motion import rig_block
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array

STEP = 1e-3


def run_ecos(path: Path, block: Block, inputs: Mapping[str, Array], outputs: list[str], step: float) -> Array:
    """Return the outputs after each step, from ecos."""
    library = Path(sys.prefix) / "lib" / "libtbb.so.12"
    if library.exists():
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("warn")
    with EcosSimulationStructure() as structure:
        structure.add_model("unit", str(path))
        structure.add_parameter_set("first", {f"unit::{n}": float(values[0]) for n, values in inputs.items()})
        with EcosSimulation(structure=structure, step_size=step) as simulation:
            simulation.init(parameter_set="first")
            rows = []
            for k in range(len(next(iter(inputs.values())))):
                for name, values in inputs.items():
                    simulation.set_real(f"unit::{name}", float(values[k]))
                simulation.step()
                rows.append([simulation.get_real(f"unit::{name}") for name in outputs])
            simulation.terminate()
    return np.array(rows)


def run_libcosim(path: Path, block: Block, inputs: Mapping[str, Array], outputs: list[str], step: float) -> Array:
    """Return the outputs after each step, from libcosim."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(step * 1e9))
    unit = execution.add_local_slave(CosimLocalSlave(str(path), "unit"))
    given, seen = CosimManipulator.create_override(), CosimObserver.create_last_value()
    execution.add_manipulator(given)
    execution.add_observer(seen)
    names = [v.name for v in list_variables(block)]
    numbers, asked = [names.index(name) for name in inputs], [names.index(name) for name in outputs]
    samples = np.column_stack(list(inputs.values()))
    for number, value in zip(numbers, samples[0], strict=True):
        execution.real_initial_value(unit, number, float(value))
    rows = []
    for row in samples:
        given.slave_real_values(unit, numbers, row.tolist())
        if not execution.step():
            raise RuntimeError("libcosim could not step")
        rows.append(list(seen.last_real_values(unit, asked)))
    return np.array(rows)


MASTERS: dict[str, tuple[str, tuple[int, ...], Callable[..., Array]]] = {
    "ecos": ("ecospy", (2, 3), run_ecos),
    "libcosim": ("libcosimpy", (2,), run_libcosim),
}
"""Programs: package, versions of the standard that they read, what runs a unit."""


def move_damper(seconds: float) -> dict[str, Array]:
    """Return samples of the inputs of a damper: two sines below 0.3 m/s, a command up to 1 A that steps."""
    t = STEP * np.arange(round(seconds / STEP))
    slow, fast, half = 2.0 * np.pi * 1.3, 2.0 * np.pi * 4.1, 0.12
    return {
        "displacement": half / slow * np.sin(slow * t) + half / fast * np.sin(fast * t),
        "velocity": half * (np.cos(slow * t) + np.cos(fast * t)),
        "acceleration": -half * (slow * np.sin(slow * t) + fast * np.sin(fast * t)),
        "command": (np.floor(3.0 * t) * 0.37) % 1.0,
        "temperature": 20.0 + 0.5 * t,
    }


def shake_rig(scenario: Scenario) -> dict[str, Array]:
    """Return samples of the inputs of a rig whose sensors have no noise, one fewer than its history has."""
    floor = scenario.excitation.floor(scenario.solver.step, scenario.seed)
    jerk = np.diff(floor.acceleration) / scenario.solver.step
    return {"floor_acceleration": floor.acceleration[:-1], "floor_velocity": floor.velocity[:-1], "floor_jerk": jerk}


def main() -> None:
    """Print a line for every program, unit and version."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0)
    seconds = parser.parse_args().seconds
    scenario = load("quickstart", {"excitation.duration": seconds})[0]
    units = {
        "damper": (damper_block(scenario), move_damper(seconds), STEP),
        "rig": (rig_block(scenario), shake_rig(scenario), scenario.solver.step),
    }
    for master, (package, versions, run) in MASTERS.items():
        if find_spec(package) is None:
            print(f"{master}: not installed (pip install {package})")
            continue
        for name, (block, inputs, step) in units.items():
            outputs = [v.name for v in list_variables(block) if v.causality == "output"]
            for version in versions:
                with tempfile.TemporaryDirectory() as place:
                    hosted = run_unit(block, version, inputs, Path(place), step)[1:]
                    found = run(Path(place) / f"unit{version}.fmu", block, inputs, outputs, step)
                off = np.max(np.abs(found - hosted), axis=0) / np.maximum(np.max(np.abs(hosted), axis=0), 1e-30)
                print(f"{master} {version_of(package)}: {name}, FMI {version}: difference {off.max():.1e}", flush=True)


if __name__ == "__main__":
    main()
