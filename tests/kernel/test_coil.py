"""The current that flows, the instants at which the law is asked, and the heat of the coil."""

import numpy as np
import pytest

from seatsim.dampers.bingham import Bingham
from seatsim.rig.coil import Coil
from seatsim.rig.temperature import Thermal

from .rigs import STEP, driven, rough

STILL = np.zeros(201)
DAMPER = Bingham(v_ref=0.1)


def exact(coil, commands, start=0.0):
    """Current at every row: exponentials from one change of the delayed command to the next."""
    time = STEP * np.arange(len(commands))
    changes = np.concatenate([[0.0], time + coil.delay])
    values = np.concatenate([[start], np.clip(commands, 0.0, coil.max_current)])
    current, now, out = start, 0.0, []
    stops = sorted([(t, 1, u) for t, u in zip(changes, values, strict=True)] + [(t, 0, None) for t in time])
    command = start
    for stop, _, new in stops:
        rate = coil.rate if command > current else (coil.rate_fall or coil.rate)
        current = command + (current - command) * np.exp(-rate * (stop - now))
        now = stop
        if new is None:
            out.append(current)
        else:
            command = new
    return np.array(out)


@pytest.mark.parametrize("delay", [0.0, 0.003, 0.0034, 0.0009])
@pytest.mark.parametrize("rate_fall", [0.0, 70.0])
@pytest.mark.parametrize("start", [0.0, 0.6])
def test_the_current_is_exact(delay, rate_fall, start, conform):
    coil = Coil(rate=176.0, rate_fall=rate_fall, delay=delay)
    commands = np.repeat(np.random.default_rng(5).uniform(-0.5, 1.5, 21), 10)[:201]
    h = driven(DAMPER, STILL, commands, coil=coil, start_current=start)
    assert h["current_command"] == pytest.approx(np.clip(commands, 0.0, 1.0), abs=0)
    deviation = np.max(np.abs(h["coil_current"] - exact(coil, commands, start)))
    falling = f"falling at {rate_fall:g} 1/s" if rate_fall else "falling as it rises"
    claim = f"coil, delay {1e3 * delay:g} ms, {falling}, from {start:g} A: greatest deviation of the current, A"
    conform(claim, "exponentials from change to change", deviation, tolerance=1e-12)


def test_a_prescribed_current_bypasses_the_coil():
    current = 0.5 + 0.4 * np.sin(40.0 * STEP * np.arange(2001))
    floor = rough(2.0, rms=3.0)
    h = driven(DAMPER, floor, 0.0, prescribed=current, start_current=current[0])
    v = h["suspension_velocity"]
    assert h["coil_current"] == pytest.approx(current, abs=1e-12)
    expected = (250.0 + 350.0 * current) * v + (45.0 + 620.0 * current) * np.tanh(v / 0.1)
    assert h["damper_force"] == pytest.approx(expected, abs=1e-9)


def test_a_still_damper_warms_up_by_its_coil(conform):
    thermal = Thermal(start=20.0, ambient=25.0, heat_capacity=2.0, conductance=4.0)
    h = driven(DAMPER, np.zeros(2001), 0.8, start_current=0.8, thermal=thermal, temperature=20.0)
    end = 25.0 + 0.8**2 * 5.0 / 4.0
    expected = end + (20.0 - end) * np.exp(-4.0 / 2.0 * STEP * np.arange(2001))
    deviation = np.max(np.abs(h["damper_temperature"] - expected))
    claim = "still damper that its coil warms up, deviation of the temperature, K"
    conform(claim, "closed form", deviation, tolerance=6.6e-3)


def test_an_insulated_damper_keeps_its_work_and_the_heat_of_its_coil(conform):
    thermal = Thermal(start=20.0, ambient=20.0, heat_capacity=3.0, conductance=0.0)
    commands = np.repeat([0.0, 1.0, 0.2], 667)
    h = driven(DAMPER, rough(2.0, rms=3.0), commands, thermal=thermal)
    ohmic = 5.0 * np.trapezoid(h["coil_current"] ** 2, dx=STEP)
    expected = 20.0 + (h["energy_damper"][-1] + ohmic) / 3.0
    found = h["damper_temperature"][-1]
    claim = "insulated damper, temperature after 2 s, degC"
    conform(claim, "balance of energy", found, expected, tolerance=1e-5 * expected)
