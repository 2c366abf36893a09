"""Exported dampers, laws and rigs beside the kernel that they are printed from.

    python benchmarks/exports.py [dampers] [laws] [rigs] [--fmi 2 3] [--seconds 60]

Every unit is validated by FMPy, run in a host in C that is built against the headers of the standard
(`fmu_host2.c`, `fmu_host3.c`), and its outputs are compared with those of the compiled kernel under the same inputs.
Printed are the greatest difference over the greatest value, the time of a step in both, and the size of the unit. The
time of the kernel is that of its compiled loop alone, for this processor; NUMBA_CPU_NAME=x86-64 with NUMBA_CPU_FEATURES
set to +sse2 compiles it for the same processors as a unit.
"""

from __future__ import annotations

import argparse
import dataclasses
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.validation import validate_fmu
from fmu_host import run_unit
from loop_alone import loop_of
from numpy.typing import NDArray

from seatsim.compilation.cached import compiled
from seatsim.compilation.jit import jit
from seatsim.dampers.base import DAMPERS
from seatsim.exchange.block import Block
from seatsim.exchange.blocks.damper import DamperInputs, advance, damper_block, observe
from seatsim.exchange.blocks.rig import rig_block
from seatsim.exchange.blocks.rig_motion import RigOutputs
from seatsim.exchange.c_source import print_model
from seatsim.exchange.compiler import undefined_symbols
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import DamperChoice, Scenario
from seatsim.schema.errors import InputError
from seatsim.simulation.simulate import simulate

Array = NDArray[np.float64]
STEP = 1e-3
advance_compiled, observe_compiled = jit(advance), jit(observe)


def main() -> None:
    """Print a line for every unit."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", default=["dampers", "laws", "rigs"])
    parser.add_argument("--fmi", nargs="*", type=int, default=[2, 3])
    parser.add_argument("--seconds", type=float, default=60.0)
    chosen = parser.parse_args()
    print(f"{'unit':44} {'fmi':>3} {'difference':>10} {'host us':>8} {'kernel us':>9} {'kB':>5}  findings")
    for what in chosen.what:
        {"dampers": compare_dampers, "laws": compare_laws, "rigs": compare_rigs}[what](chosen.fmi, chosen.seconds)


def compare_dampers(versions: list[int], seconds: float) -> None:
    """Compare every damper of the library."""
    base = load("quickstart")[0]
    for name in DAMPERS.names():
        cls: Any = DAMPERS.find(name)
        specification = DAMPERS.specification_of(cls)
        choice = DamperChoice(cls(), specification.factors)
        block = damper_block(dataclasses.replace(base, name=name, damper=choice, effects=()))
        inputs = motion(seconds, specification.max_speed, specification.max_current)
        rows, out = np.column_stack(list(inputs.values())), np.empty((round(seconds / STEP), 2))
        run: Any = compiled(drive, block.parts)
        arguments = (block.parameters, rows, block.rest, STEP, out)
        run(*arguments)
        spent = least_time(lambda: run(*arguments))  # noqa: B023  # called at once
        for version in versions:
            report(name, block, version, inputs, {"force": out[:, 0], "current": out[:, 1]}, 1, spent)


def least_time(run: Callable[[], object]) -> float:
    """Return the least time in s of three calls, since others use the machine too."""
    spent = []
    for _ in range(3):
        begun = time.process_time()
        run()
        spent.append(time.process_time() - begun)
    return min(spent)


def drive(p: Any, rows: Array, rest: Any, step: float, out: Array) -> None:
    """Fill `out` with the outputs of a damper after each step; to be compiled."""
    state = rest
    for k in range(len(rows)):
        u = DamperInputs(rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4])
        state, _good = advance_compiled(p, u, state, 0.0, step)
        seen = observe_compiled(p, u, state, step)
        out[k, 0], out[k, 1] = seen.force, seen.current


def motion(seconds: float, speed: float, current: float) -> dict[str, Array]:
    """Return samples of the inputs of a damper: two sines below a speed in m/s, a command in A that steps."""
    t = STEP * np.arange(round(seconds / STEP))
    slow, fast, half = 2.0 * np.pi * 1.3, 2.0 * np.pi * 4.1, 0.4 * speed
    return {
        "displacement": half / slow * np.sin(slow * t) + half / fast * np.sin(fast * t),
        "velocity": half * (np.cos(slow * t) + np.cos(fast * t)),
        "acceleration": -half * (slow * np.sin(slow * t) + fast * np.sin(fast * t)),
        "command": current * ((np.floor(3.0 * t) * 0.37) % 1.0),
        "temperature": 20.0 + 0.5 * t,
    }


def compare_laws(versions: list[int], seconds: float) -> None:
    """Compare the rig under every law of the example `laws`; say which cannot be exported, and why."""
    for scenario in load("laws"):
        compare_rig(f"laws: {scenario.label['variant']}", scenario, versions)


def compare_rigs(versions: list[int], seconds: float) -> None:
    """Compare rigs with effects on damper, suspension, cushion and driver, sensors, delay and self-heating."""
    effects = [
        {"effect": "damper.seal_friction", "parameters": {"force": 15.0}},
        {"effect": "damper.remanence", "parameters": {"width": 0.05}},
        {"effect": "damper.free_play", "parameters": {"gap": 2e-4}},
        {"effect": "suspension.end_stop", "parameters": {"low": -0.045, "high": 0.045}},
        {"effect": "cushion.hardening", "parameters": {"rise": 40.0}},
        {"effect": "driver.biodynamics", "parameters": {"share": 0.2}},
        {"effect": "coil.delay", "parameters": {"time": 0.0043}},
    ]
    for name in ("quickstart", "self-heating", "driver-masses", "bumps", "hot-damper-cold-inverse"):
        compare_rig(name, load(name)[0], versions)
    compare_rig("quickstart with seven effects", load("quickstart", {"effects": effects})[0], versions)


def compare_rig(name: str, scenario: Scenario, versions: list[int]) -> None:
    """Compare a rig with the history of its simulation."""
    try:
        block = rig_block(scenario)
        print_model(block)  # refuses what has no counterpart, before anything is simulated
        inputs = floor_of(scenario)
        history = simulate(scenario, carry_all_effects=False)
        spent = least_time(loop_of(scenario, carry_all_effects=False))
        # The command of a unit is that of the step that has ended, the history's that of the step that begins.
        wanted = {n: history[n][:-1] if n == "current_command" else history[n][1:] for n in RigOutputs._fields}
        for version in versions:
            report(name, block, version, inputs, wanted, 1, spent)
    except InputError as error:
        print(f"{name:44} left out: {str(error)[:100]}")


def floor_of(scenario: Scenario) -> dict[str, Array]:
    """Return samples of a rig's inputs, one fewer than the history has."""
    floor = scenario.excitation.floor(scenario.solver.step, scenario.seed)
    inputs = {
        "floor_acceleration": floor.acceleration[:-1],
        "floor_velocity": floor.velocity[:-1],
        "floor_jerk": np.diff(floor.acceleration) / scenario.solver.step,
    }
    control = scenario.control
    if control is not None and control.sensors:
        every = round((control.sample_time or 0.001) / scenario.solver.step)
        noise = control.sensors.noise(-(-len(floor.acceleration) // every), scenario.seed)
        names = ("displacement_noise", "frame_noise", "driver_noise", "floor_noise")
        rows = np.repeat(noise, every, axis=0)[: len(floor.acceleration) - 1]
        inputs |= dict(zip(names, rows.T, strict=True))
    return inputs


def report(
    name: str,
    block: Block,
    version: int,
    inputs: Mapping[str, Array],
    wanted: Mapping[str, Array],
    skip: int,
    kernel_seconds: float,
) -> None:
    """Print the line of a unit."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        hosted = run_unit(block, version, inputs, folder, block.step if block.fixed_step else STEP, runs=3)
        archive = folder / f"unit{version}.fmu"
        findings = validate_fmu(str(archive))
        symbols = undefined_symbols(hosted.library)
        size = archive.stat().st_size / 1e3
    steps = len(hosted.outputs) - 1
    off = []
    for k, values in enumerate(wanted.values()):
        scale = max(float(np.max(np.abs(values))), 1e-30)
        off.append(float(np.max(np.abs(hosted.outputs[skip:, k] - values))) / scale)
    foreign = [symbol for symbol in symbols if "Py" in symbol or "NRT" in symbol or "numba" in symbol]
    print(
        f"{name:44} {version:3} {max(off):10.1e} {1e6 * hosted.seconds / steps:8.3f}"
        f" {1e6 * kernel_seconds / steps:9.3f} {size:5.1f}  {len(findings) + len(foreign)}",
        flush=True,
    )


if __name__ == "__main__":
    main()
