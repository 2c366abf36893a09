"""A run under test made of arrays at hand, and the recording of a bench."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

from seatsim.dampers.bouc_wen import BoucWen
from seatsim.recordings.quality.issue import RunUnderTest
from seatsim.recordings.recording import SEAT_CHANNELS, ChannelEntry, Header, Recording, RunEntry
from seatsim.scenario.loading import single
from seatsim.simulation.damper_bench import bench_force

from ...faulty_recordings import RATE


@pytest.fixture
def under_test(kept_seat_file):
    """A function from channels, their noise and the rate to a run of a seat with its nominal scenario."""
    nominal = single(kept_seat_file)

    def build(table, rate=250.0, noise=None, name="run-a", repeat_of=None):
        stated = noise or {}
        channels = {channel: ChannelEntry(SEAT_CHANNELS[channel], stated.get(channel, 0.0)) for channel in table}
        runs = {name: RunEntry(name, f"{name}.csv", repeat_of)}
        recording = Recording(Path("nowhere"), Header("seat", rate, "nominal.yaml"), runs, channels, None)
        return RunUnderTest(name, table, recording, nominal)

    return build


DAMPER = BoucWen(
    c_a=500.0, c_b=800.0, alpha_a=60.0, alpha_b=500.0, k0=900.0, f0=30.0, A=2000.0, beta=1300.0, gamma=900.0, n=2.0
)


def multisine(time, seed):
    phases = np.random.default_rng(seed).uniform(0.0, 6.0, 8)
    tones = sum(0.006 / k * np.sin(2 * np.pi * 0.6 * k * time + phases[k - 1]) for k in range(1, 9))
    return (1.0 - np.exp(-(time**2))) * tones


MOTIONS = {
    "slow": (lambda t: 0.02 * np.sin(np.pi * t), 0.5),
    "fast": (lambda t: 0.01 * np.sin(4 * np.pi * t), 1.0),
    "random": (lambda t: multisine(t, 1), 0.7),
}


@pytest.fixture(scope="session")
def bench(tmp_path_factory):
    """The folder of a bench: two sines and a random motion, each at its current; no test edits it."""
    folder, generator = tmp_path_factory.mktemp("bench"), np.random.default_rng(1)
    for name, (motion, current) in MOTIONS.items():
        time = 0.5 / RATE * np.arange(2 * round(12.0 * RATE) - 1)
        stroke = motion(time)
        force = bench_force(DAMPER, stroke, np.gradient(stroke, 0.5 / RATE), current, 20.0, 1.0 / RATE)
        noise = generator.standard_normal((2, len(force)))
        columns = {"displacement": stroke[::2] + 2e-5 * noise[0], "damper_force": force + 3.0 * noise[1]}
        pd.DataFrame(columns | {"coil_current": current}).to_csv(folder / f"{name}.csv.gz", index=False)
    units = {"displacement": ("m", 2e-5), "damper_force": ("N", 3.0), "coil_current": ("A", 0.0)}
    header = {"rig": "damper_bench", "sample_rate": RATE, "nominal": "nominal.yaml"}
    header |= {"runs": [{"name": name, "file": f"{name}.csv.gz"} for name in MOTIONS]}
    header |= {"channels": {c: {"unit": u, "noise_rms": n} for c, (u, n) in units.items()}}
    nominal = {"damper": {"model": "bouc_wen", "parameters": DAMPER._asdict()}, "temperature": 20.0}
    nominal |= {"actuator": {"rate": 130.0, "max_current": 1.0}}
    YAML(typ="safe").dump(header, folder / "recording.yaml")
    YAML(typ="safe").dump(nominal, folder / "nominal.yaml")
    return folder
