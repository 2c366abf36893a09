"""Small recordings that carry cases: a damper bench with a switched current, and a seat without a damper."""

import numpy as np
from ruamel.yaml import YAML

from seatsim.blind.carrier.recorded import Carrier, encode_carrier
from seatsim.blind.carrier.seat import simulate_linear

from ..text import parse

RATE, SECONDS, COIL_RATE = 500.0, 4.0, 60.0
C, FC = (400.0, 900.0), (60.0, 500.0)
BENCH_CHANNELS, SEAT_CHANNELS, PLANT = parse("""
    - {displacement: {unit: m}, damper_force: {unit: N, noise_rms: 0.5}, current_command: {unit: A}}
    - {floor_acceleration: {unit: m/s^2}, driver_acceleration: {unit: m/s^2, noise_rms: 0.001},
       suspension_displacement: {unit: m, noise_rms: 0.000001}}
    - {frame_mass: 20.0, driver_mass: 80.0, suspension_stiffness: 9000.0, suspension_damping: 600.0,
       cushion_stiffness: 60000.0, cushion_damping: 1500.0}
""")
SCALES = ("c_a", "c_b", "fc_a", "fc_b")


def rig(name, tolerance, channels, tables, nominal, forces, **actuator):
    """Return a carrier whose nominal has a Bingham damper with these forces."""
    parameters = dict(zip(SCALES, forces, strict=True)) | {"f0": 0.0, "v_ref": 0.02}
    common = {"damper": {"model": "bingham", "parameters": parameters}, "actuator": actuator, "temperature": 20.0}
    runs = [{"name": run, "file": f"{run}.csv.gz"} for run in tables]
    header = {"rig": name, "sample_rate": RATE, "parameter_tolerance": tolerance, "nominal": "nominal.yaml"}
    return Carrier({**header, "runs": runs, "channels": channels}, nominal | common, tables)


def draw_waves(rng, time, count, low, high):
    """Return a sum of sines of unit amplitude between two frequencies in Hz."""
    waves = [(rng.uniform(low, high), rng.uniform(0.0, 2.0 * np.pi)) for _ in range(count)]
    return sum(np.sin(2.0 * np.pi * f * time + p) for f, p in waves)


def bench_carrier(tolerance=0.0, logged_coil=False):
    """Return three runs of a Bingham damper under random motion and a switched current, as its nominal has them."""
    channels = BENCH_CHANNELS | ({"coil_current": {"unit": "A", "noise_rms": 1e-4}} if logged_coil else {})
    tables = {f"run-{k}": bench_run(k, logged_coil) for k in range(3)}
    return rig("damper_bench", tolerance, channels, tables, {}, (*C, *FC), rate=COIL_RATE, max_current=2.0)


def bench_run(seed, logged_coil):
    rng, time = np.random.default_rng(seed), np.arange(round(RATE * SECONDS)) / RATE
    x = 0.005 * np.clip(time / 0.3, 0.0, 1.0) * draw_waves(rng, time, 5, 0.8, 5.0)
    command = np.repeat(rng.choice([0.0, 0.3, 0.6, 1.0], len(time) // 100 + 1), 100)[: len(time)]
    current, v = coil(command, COIL_RATE), np.gradient(x, 1.0 / RATE)
    force = (C[0] + C[1] * current) * v + (FC[0] + FC[1] * current) * np.tanh(v / 0.02)
    force = force + 0.5 * rng.standard_normal(len(time))
    table = {"displacement": x, "damper_force": force, "current_command": command}
    return table | ({"coil_current": current} if logged_coil else {})


def coil(command, rate):
    """Return the current that follows a held command, at rest at the start."""
    current, keep = np.zeros(len(command)), np.exp(-rate / RATE)
    for k in range(1, len(command)):
        current[k] = command[k - 1] + (current[k - 1] - command[k - 1]) * keep
    return current


def write_carrier(carrier, folder):
    """Write a carrier as a recording."""
    folder.mkdir(parents=True)
    for name, data in encode_carrier(carrier, tuple(carrier.tables)).items():
        (folder / name).write_bytes(data)
    return folder


def offset(carrier, newtons):
    """Return a carrier whose load cell reads so much more."""
    tables = {run: {**t, "damper_force": t["damper_force"] + newtons} for run, t in carrier.tables.items()}
    return carrier._replace(tables=tables)


def seat_carrier():
    """Return two runs of a linear seat on a random floor; its outputs are those of its own nominal, without noise."""
    tables, time = {}, np.arange(round(RATE * 6.0)) / RATE
    for k in range(2):
        floor = np.clip(time, 0.0, 1.0) * draw_waves(np.random.default_rng(k), time, 6, 1.0, 6.0)
        motion = simulate_linear(PLANT, floor, 1.0 / RATE)
        tables[f"run-{k}"] = dict(zip(SEAT_CHANNELS, (floor, motion.driver, motion.x), strict=True))
    nominal = {"plant": PLANT, "controller": {"law": "replay", "current": 0.0}, "excitation": {"kind": "recording"}}
    return rig("seat", 0.0, SEAT_CHANNELS, tables, nominal, (0.0,) * 4, rate=130.0, max_current=1.0)


def write_yaml(content, path):
    """Write a scenario."""
    YAML(typ="safe").dump(content, path)
    return path


def files_of(folder, but="no such name"):
    """Return the bytes of every file below a folder by its place there, but of those whose name holds a word."""
    found = {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*.*")) if path.is_file()}
    return {name: path.read_bytes() for name, path in found.items() if but not in name}
