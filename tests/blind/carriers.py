"""Small recordings that carry cases: a damper bench with a switched current, and a seat without a damper."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML

from seatsim.blind.carrier.recorded import Carrier, Table, encode_carrier

from ..text import parse

Array = NDArray[np.float64]
RATE, SECONDS = 500.0, 4.0
C, FC = (400.0, 900.0), (60.0, 500.0)
BENCH_CHANNELS = {
    "displacement": {"unit": "m"},
    "damper_force": {"unit": "N", "noise_rms": 0.5},
    "current_command": {"unit": "A"},
}
PLANT = parse("""
    {frame_mass: 20.0, driver_mass: 80.0, suspension_stiffness: 9000.0, suspension_damping: 600.0,
     cushion_stiffness: 60000.0, cushion_damping: 1500.0}
""")


def bench_carrier(tolerance: float = 0.0, logged_coil: bool = False, rate: float = 60.0) -> Carrier:
    """Return three runs of a Bingham damper under random motion and a switched current, as its nominal has them."""
    nominal = {
        "damper": {
            "model": "bingham",
            "parameters": {"c_a": C[0], "c_b": C[1], "fc_a": FC[0], "fc_b": FC[1], "f0": 0.0, "v_ref": 0.02},
        },
        "actuator": {"rate": rate, "max_current": 2.0},
        "temperature": 20.0,
    }
    channels = {**BENCH_CHANNELS, **({"coil_current": {"unit": "A", "noise_rms": 1e-4}} if logged_coil else {})}
    header = {"rig": "damper_bench", "sample_rate": RATE, "parameter_tolerance": tolerance, "nominal": "nominal.yaml"}
    tables = {f"run-{k}": _bench_run(k, logged_coil, rate) for k in range(3)}
    runs = [{"name": run, "file": f"{run}.csv.gz"} for run in tables]
    return Carrier({**header, "runs": runs, "channels": channels}, nominal, tables)


def _bench_run(seed: int, logged_coil: bool, rate: float) -> Table:
    rng, rows = np.random.default_rng(seed), round(RATE * SECONDS)
    time = np.arange(rows) / RATE
    waves = [(rng.uniform(0.8, 5.0), rng.uniform(0.0, 2.0 * np.pi)) for _ in range(5)]
    shape = sum(np.sin(2.0 * np.pi * f * time + p) for f, p in waves)
    x = 0.005 * np.clip(time / 0.3, 0.0, 1.0) * shape
    command = np.repeat(rng.choice([0.0, 0.3, 0.6, 1.0], rows // 100 + 1), 100)[:rows]
    current = coil(command, rate)
    v = np.gradient(x, 1.0 / RATE)
    force = (C[0] + C[1] * current) * v + (FC[0] + FC[1] * current) * np.tanh(v / 0.02)
    force = force + 0.5 * rng.standard_normal(rows)
    table = {"displacement": x, "damper_force": force, "current_command": command}
    return table | ({"coil_current": current} if logged_coil else {})


def coil(command: Array, rate: float) -> Array:
    """Return the current that follows a held command, at rest at the start."""
    current, keep = np.zeros(len(command)), np.exp(-rate / RATE)
    for k in range(1, len(command)):
        current[k] = command[k - 1] + (current[k - 1] - command[k - 1]) * keep
    return current


def write_carrier(carrier: Carrier, folder: Path) -> Path:
    """Write a carrier as a recording."""
    folder.mkdir(parents=True)
    for name, data in encode_carrier(carrier, tuple(carrier.tables)).items():
        (folder / name).write_bytes(data)
    return folder


def seat_carrier() -> Carrier:
    """Return two runs of a linear seat on a random floor; its outputs are those of its own nominal, without noise."""
    from seatsim.blind.carrier.seat import simulate_linear

    nominal = {
        "plant": PLANT,
        "damper": {
            "model": "bingham",
            "parameters": {"c_a": 0.0, "c_b": 0.0, "fc_a": 0.0, "fc_b": 0.0, "f0": 0.0, "v_ref": 0.02},
        },
        "actuator": {"rate": 130.0, "max_current": 1.0},
        "temperature": 20.0,
        "controller": {"law": "replay", "current": 0.0},
        "excitation": {"kind": "recording"},
    }
    tables = {}
    for k in range(2):
        rng, rows = np.random.default_rng(k), round(RATE * 6.0)
        time = np.arange(rows) / RATE
        waves = [(rng.uniform(1.0, 6.0), rng.uniform(0.0, 2.0 * np.pi)) for _ in range(6)]
        floor = np.clip(time, 0.0, 1.0) * np.asarray(sum(np.sin(2.0 * np.pi * f * time + p) for f, p in waves))
        motion = simulate_linear(PLANT, floor, 1.0 / RATE)
        tables[f"run-{k}"] = {
            "floor_acceleration": floor,
            "driver_acceleration": motion.driver,
            "suspension_displacement": motion.x,
        }
    channels = {
        "floor_acceleration": {"unit": "m/s^2"},
        "driver_acceleration": {"unit": "m/s^2", "noise_rms": 1e-3},
        "suspension_displacement": {"unit": "m", "noise_rms": 1e-6},
    }
    header = {"rig": "seat", "sample_rate": RATE, "parameter_tolerance": 0.0, "nominal": "nominal.yaml"}
    runs = [{"name": run, "file": f"{run}.csv.gz"} for run in tables]
    return Carrier({**header, "runs": runs, "channels": channels}, nominal, tables)


def write_yaml(content: object, path: Path) -> Path:
    """Write a scenario."""
    YAML(typ="safe").dump(content, path)
    return path
