"""The time loop as plain Python: the order in which law, coil, rig and temperature act, and what it records."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from seatsim.kernel.generic import AssumedModel, TrueModel
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_data import CHANNELS, LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import Rig
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.sensors import Direct, Sensors, at_rest
from seatsim.rig.temperature import TemperatureFactors, Thermal

from ..text import words
from .uncompiled import Commanded, Feedback, Linear

pytestmark = pytest.mark.usefixtures("uncompiled")
PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0, damper_ratio=0.8)
COIL = Coil(rate=150.0, rate_fall=60.0)
STEP, NONE = 1e-3, np.zeros(0)
FACTORS = TemperatureFactors(-0.01, 0.0, -0.02, 20.0)


def run(
    law, *, rows=40, damper=None, coil=COIL, every=1, model=None, top=1.0, thermal=None, sensors=None,
    heating=False, law_state=(), rest=(), followed=(), floor=None, **inputs,
):  # fmt: skip
    """Run and return the history by channel, and the sample that was reached."""
    damper = damper or Linear(k=0.0)
    floor = 3.0 * np.sin(40.0 * STEP * np.arange(rows)) if floor is None else floor
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (floor[1:] + floor[:-1]))])
    given = dict.fromkeys(("replayed", "prescribed", "frame_force", "driver_force"), NONE)
    given |= {"temperature": np.full(rows, 20.0)}
    model, timing = model or TrueModel(damper), Timing(STEP, every, 1e-4, heating)
    rig, heat = Rig(PLANT, damper), thermal or Thermal()
    setup = LoopSetup(rig, coil, FACTORS, heat, law, model, timing, top, sensors or Direct())
    out = np.full((rows, len(CHANNELS)), np.nan)
    given = LoopInputs(floor, velocity, **(given | inputs))
    reached = run_loop(setup, given, rest, followed, law_state, out, np.empty(CELLS + 1))
    return dict(zip(CHANNELS, out.T, strict=True)) | {"floor_velocity": velocity}, reached


def test_a_law_is_asked_at_its_samples_and_its_command_stands_between():
    damper = Linear(k=0.0)
    h, _ = run(Feedback(1000.0), every=5, law_state=(0.0,), damper=damper)
    asked = np.repeat(np.arange(0, 40, 5), 5)
    v = h["suspension_velocity"]
    assert h["wanted_force"] == pytest.approx(1000.0 * v[asked], rel=1e-12)
    # The inverse of this damper is (1000 v - 800 r v) / (300 r v), beyond 1 A here: what it gives falls short.
    needed = (1000.0 - 800.0 * 0.8) / (300.0 * 0.8)
    assert needed > 1.0
    assert h["current_command"][5:] == pytest.approx(np.full(35, 1.0))
    assert np.all(h["force_served"][5:] == 0.0)
    h, _ = run(Feedback(750.0), every=5, law_state=(0.0,))
    assert h["current_command"][5:] == pytest.approx(np.full(35, (750.0 - 640.0) / 240.0), rel=1e-9)
    assert np.all(h["force_served"][5:] == 1.0)


class Charged(NamedTuple):
    """A damper whose state is the integral of its current: `F = (c + 500 i + 2000 z) v`."""

    c: float = 300.0

    def force(self, x, v, i, scaling, z):
        return (self.c + 500.0 * i + 2000.0 * z[0]) * v

    def rates(self, x, v, i, scaling, z):
        return (i,)


def test_an_assumed_state_follows_the_current_that_flows():
    law = {"law_state": (0.0,), "damper": Charged(), "rest": (0.0,), "followed": (0.0,), "start_velocity": 0.1}
    knows, _ = run(Feedback(450.0), model=TrueModel(Charged()), **law)
    assumes, _ = run(Feedback(450.0), model=AssumedModel(Charged(), FACTORS, math.nan), **law)
    assert np.ptp(knows["current_command"][2:]) > 0.01
    assert assumes["current_command"] == pytest.approx(knows["current_command"], abs=5e-4)


def spy(seen):
    """Return a law that keeps what it is shown."""

    class Spy(Commanded):
        def update(self, y, state):
            seen.append(y)
            return state

    return Spy(0.5)


def test_a_law_with_sensors_sees_filtered_readings():
    sensors = Sensors(bandwidth=20.0)
    made = sensors.instruments(STEP, 5 * STEP)
    noise = np.zeros((8, 4))
    noise[:, 0] = 0.001 * np.arange(8)
    seen = []
    h, _ = run(spy(seen), sensors=made, every=5, sensed=at_rest(0.0), noise=noise)
    x, rate = 0.0, 2 * math.pi * 20.0
    keep = math.exp(-rate * STEP)
    mean = (1.0 - keep) / (rate * STEP)
    filtered, past = [], 0.0
    for now in h["suspension_displacement"]:
        x, past = keep * x + (mean - keep) * past + (1.0 - mean) * now, now
        filtered.append(x)
    assert [y.displacement for y in seen] == pytest.approx(np.array(filtered)[::5] + noise[:, 0], rel=1e-9)
    assert [y.time for y in seen] == pytest.approx(STEP * np.arange(0, 40, 5))


def test_without_sensors_a_law_sees_what_is_recorded():
    seen = []
    replayed = np.arange(40.0)
    h, _ = run(spy(seen), every=3, replayed=replayed)
    rows = np.arange(0, 40, 3)
    v, floor = h["suspension_velocity"], h["floor_velocity"]
    same = words("floor_acceleration frame_acceleration driver_acceleration damper_force")
    expected = {name: h[name] for name in same} | {"time": STEP * np.arange(40), "velocity": v, "replayed": replayed}
    expected |= {"frame_velocity": v + floor, "driver_velocity": v + floor + h["cushion_velocity"]}
    expected |= {"displacement": h["suspension_displacement"], "current": h["coil_current"]}
    expected |= {"temperature": h["damper_temperature"]}
    for name, values in expected.items():
        assert [getattr(y, name) for y in seen] == pytest.approx(values[rows], rel=1e-12, abs=1e-15), name


def test_a_lost_solution_stops_the_run():
    floor = np.ones(30)
    floor[12:] = np.nan
    h, reached = run(Commanded(0.5), rows=30, floor=floor)
    assert reached == 11
    assert np.isfinite(h["frame_acceleration"][:12]).all() and np.isnan(h["frame_acceleration"][12:]).all()
