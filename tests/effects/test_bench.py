"""Effects on a damper bench."""

import math

import numpy as np
import pandas as pd
import pytest

import seatsim
from seatsim.effects.base import ON_SEAT, acts_on
from seatsim.recordings.gap import measure_gap
from seatsim.rig.coil import Coil, relax
from seatsim.schema.registry import find

from .rigs import BINGHAM, INERT, NAMES, STEP, bench, cycles, record, starts

RIG = f"""\
damper: {{model: bingham, parameters: {BINGHAM._asdict()}}}
actuator: {{rate: 130.0, max_current: 1.0}}
temperature: 20.0
effects: []
"""
EFFECTS = """\
effects:
  - {effect: damper.seal_friction, parameters: {force: 40.0, presliding: 5.0e-4}}
  - {effect: coil.lag, parameters: {time: 0.02}}
  - {effect: sensor.gain, parameters: {channel: damper_force, error: 0.1}}
"""
HEADER = """\
rig: damper_bench
sample_rate: 1000.0
nominal: nominal.yaml
runs: [{name: a, file: a.csv}]
channels: {displacement: {unit: m, noise_rms: 1.0e-6}, current_command: {unit: A}, coil_current: {unit: A},
           damper_force: {unit: N, noise_rms: 2.0}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A recording of a damper with seal friction, a slow coil and a load cell that reads too much."""
    place = tmp_path_factory.mktemp("bench")
    x, v = cycles(amplitude=0.008, frequency=1.3, count=5)
    rows = len(x[::2])
    command = np.where(np.arange(rows) // 500 % 2 == 0, 0.2, 0.8)
    coil = record("coil.lag", time=0.02).coil(Coil())
    current = [0.2]
    for row in range(2 * (rows - 1)):
        current.append(relax(coil, current[-1], command[row // 2], 0.5 * STEP))
    force = 1.1 * bench([record("damper.seal_friction", force=40.0, presliding=5e-4)], x, v, np.array(current))
    columns = {"displacement": x[::2], "current_command": command, "coil_current": current[::2], "damper_force": force}
    pd.DataFrame(columns).to_csv(place / "a.csv", index=False)
    (place / "recording.yaml").write_text(HEADER)
    (place / "nominal.yaml").write_text(RIG)
    return place


def test_the_effects_of_a_bench_close_its_gap(folder, tmp_path):
    (tmp_path / "rig.yaml").write_text(RIG.replace("effects: []\n", EFFECTS))
    assert measure_gap(folder / "nominal.yaml", folder).overall > 0.1
    assert measure_gap(tmp_path / "rig.yaml", folder).overall < 0.01


def test_effects_of_the_seat_are_refused_on_a_bench(folder, tmp_path):
    for name in NAMES:
        if acts_on(find("effect", name), (*ON_SEAT, "plant", "frame_force")):
            values = (starts(name) or [record(name, rms=10.0)])[0]._asdict()
            listed = ", ".join(f"{key}: {value!r}" for key, value in values.items())
            (tmp_path / "rig.yaml").write_text(RIG.replace("[]", f"[{{effect: {name}, parameters: {{{listed}}}}}]"))
            with pytest.raises(seatsim.InputError, match=f"no part on which {name} acts"):
                measure_gap(tmp_path / "rig.yaml", folder)


def test_an_elastic_mount_and_a_dashpot_are_a_maxwell_element():
    """S + T S' = c v with T = c / K, and 1 / 5000 s more in which the piston's speed settles."""
    stiffness, c, hertz = 2e5, 600.0, 5.0
    x, v = cycles(frequency=hertz, count=10)
    force = bench([record("damper.free_play", gap=0.0, stiffness=stiffness)], x, v, damper=INERT._replace(c_a=c))
    settled = slice(len(force) // 2, None)
    expected = np.max(v) * c / math.hypot(1.0, 2.0 * math.pi * hertz * (c / stiffness + 2e-4))
    assert np.max(np.abs(force[settled])) == pytest.approx(expected, rel=0.01)
