"""Bench records of known dampers, as objects and as tables."""

import math

import numpy as np
import pandas as pd

from seatsim.dampers.bingham import Bingham
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.kernel.bench import simulate_current
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import TemperatureFactors
from seatsim.simulation.damper_bench import bench_force

BINGHAM = Bingham(c_a=400.0, c_b=900.0, fc_a=60.0, fc_b=500.0, f0=30.0, v_ref=0.004)
BOUC_WEN = BoucWen(
    c_a=500.0, c_b=800.0, alpha_a=60.0, alpha_b=500.0, k0=900.0, f0=30.0, A=2000.0, beta=1300.0, gamma=900.0, n=2.0
)


def made(damper=BINGHAM, amplitude=0.01, frequency=2.0, current=0.0, seconds=2.0, rate=500.0, noise=0.0, coil=(),
         temperature=None, factors=None, warming=0.0, name="made", seed=1):  # fmt: skip
    """Return the record of a sine test; `current` is a number or a function of time, a command where `coil` has rates.

    noise: standard deviation over that of the force.
    """
    step = 1.0 / rate
    t = 0.5 * step * np.arange(2 * round(seconds * rate) + 1)
    x = amplitude * np.sin(2.0 * math.pi * frequency * t)
    v = 2.0 * math.pi * frequency * amplitude * np.cos(2.0 * math.pi * frequency * t)
    command = np.asarray(current(t) if callable(current) else current + 0.0 * t, dtype=float)
    if coil:
        command = np.repeat(command[::2], 2)[:-1]
    flowing = simulate_current(Coil(coil[0], rate_fall=coil[1]), command, 0.5 * step, command[0]) if coil else command
    warm = 20.0 if temperature is None else temperature
    factors = factors or TemperatureFactors()
    force = bench_force(damper, x, v, flowing, warm, step, factors) + warming * (warm - factors.reference)
    force += noise * np.std(force) * np.random.default_rng(seed).standard_normal(len(force))
    warmth = None if temperature is None else np.full(len(force), float(temperature))
    return BenchRecord(name, f"{name}.csv", rate, x[::2], v[::2], force, command[::2], bool(coil), warmth)


def sines(damper, noise=0.02):
    """Return three sine records at three currents."""
    settings = ((0.01, 2.0, 0.0), (0.002, 4.0, 0.5), (0.006, 2.5, 1.0))
    return [made(damper, x, f, i, noise=noise, name=f"sine_{f:g}Hz", seed=k) for k, (x, f, i) in enumerate(settings)]


def columns(record):
    """Return a record as a table with units in its names."""
    table = {"time_s": record.time, "displacement_mm": 1e3 * record.displacement, "velocity_m_s": record.velocity}
    table |= {"force_kN": 1e-3 * record.force, "current_A": record.current}
    return pd.DataFrame(table)


def write(records, folder):
    """Write every record as a table of a folder, and return the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for record in records:
        columns(record).to_csv(folder / record.file, index=False)
    return folder
