"""Runs without a simulation, to draw pictures of."""

import numpy as np
import pytest

from seatsim.dampers.bouc_wen import BoucWen
from seatsim.metrics.table import summarise
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import DamperChoice, Scenario
from seatsim.simulation.result import UNITS, History, Run

PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0, travel=(-0.05, 0.05))
FADING = TemperatureFactors(viscous=-0.0067, yield_force=-0.0067)
STEP = 0.002


@pytest.fixture(scope="session", name="made_up")
def made_up_fixture():
    return made_up


def made_up(label=None, name="seat", motion=1.0, seconds=9.0, warming=0.0, wanted=True, factors=FADING):
    """Return a run: a floor of noise, a driver who follows it smoothly, a suspension that swings."""
    label = label or {}
    temperature, damper = float(label.get("temperature", 20.0)), DamperChoice(BoucWen(), factors)
    scenario = Scenario(name, damper, Coil(), temperature, PLANT, label=label)
    channels = made_up_channels(round(seconds / STEP), motion, warming, wanted)
    metrics = summarise(channels, STEP, travel=PLANT.travel, coil_resistance=5.0)
    return Run(scenario, History(STEP, channels), metrics)


def made_up_channels(n, motion, warming, wanted):
    noise = np.random.default_rng(1).standard_normal(n)
    x = 0.02 * motion * np.sin(2 * np.pi * 1.2 * STEP * np.arange(n))
    v = np.gradient(x, STEP)
    channels = {channel: np.zeros(n) for channel in UNITS}
    channels |= {"time": STEP * np.arange(n), "suspension_displacement": x, "suspension_velocity": v}
    smooth = np.convolve(noise, np.full(40, 1 / 40))[:n]
    channels |= {"floor_acceleration": motion * noise, "driver_acceleration": motion * smooth}
    channels |= {"damper_force": 1500 * v, "wanted_force": 2000 * v if wanted else np.full(n, np.nan)}
    warm = 20.0 + warming * np.linspace(0, 1, n)
    return channels | {"coil_current": np.minimum(1.0, np.abs(v)), "damper_temperature": warm}
