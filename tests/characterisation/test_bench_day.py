"""A whole bench day of known dampers: every figure is that of the damper, computed apart."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from seatsim.characterisation.summary import characterise
from seatsim.dampers.bingham import Bingham
from seatsim.dampers.biviscous import Biviscous
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.rig.temperature import TemperatureFactors
from seatsim.simulation.damper_bench import bench_force

RATE, GAS, SPRING, NOISE, DRIFT = 2000.0, 60.0, 500.0, 2.0, 0.05
"""Hz, N, N/m, N, N/s."""
FACTORS = TemperatureFactors(viscous=-0.004, yield_force=-0.002)
CURRENTS = np.linspace(0.0, 2.0, 9)
TEMPERATURES = (20.0, 50.0, 80.0)
TESTS = ((0.025, 0.1, 3), (0.025, 1.0, 12))
"""Amplitude in m, frequency in Hz and cycles."""


class Truth(NamedTuple):
    """A cycle of the damper alone, without gas, noise or drift."""

    velocity: np.ndarray
    force: np.ndarray
    energy: float
    peak: float


def cycle(damper, x, f, current, warm):
    """The last of three cycles at 20000 steps each: its force at mid-stroke and its work."""
    samples = 20000
    phase = np.pi / samples * np.arange(6 * samples + 1)
    v = 2 * np.pi * f * x * np.cos(phase)
    force = bench_force(damper, x * np.sin(phase), v, current, warm, 1 / (f * samples), FACTORS)[-samples - 1 :]
    v = v[::2][-samples - 1 :]
    return Truth(v, force, np.trapezoid(force * v) / (f * samples), 0.5 * (force[0] - force[samples // 2]))


def bench(damper, x, f, cycles, current, warm, rng):
    """What the bench records of it."""
    fine = np.arange(2 * round(RATE * cycles / f) + round(RATE / f)) / (2 * RATE)
    fine = fine[: len(fine) // 2 * 2 - 1]
    moved, v = x * np.sin(2 * np.pi * f * fine), 2 * np.pi * f * x * np.cos(2 * np.pi * f * fine)
    force = bench_force(damper, moved, v, current, warm, 1 / RATE, FACTORS)
    time, moved, v = fine[::2], moved[::2], v[::2]
    force = force + GAS + SPRING * moved + DRIFT * (time - time.mean()) + NOISE * rng.standard_normal(len(time))
    level = np.full(len(time), current)
    return BenchRecord("day", "day.csv", RATE, moved, v, force, level, False, np.full(len(time), warm))


DAMPERS = {"bingham": Bingham(v_ref=0.01), "biviscous": Biviscous(), "bouc_wen": BoucWen(A=2000.0)}


@pytest.mark.slow
@pytest.mark.parametrize("name", DAMPERS)
def test_every_figure_of_a_day_is_that_of_the_damper(name):
    damper, rng = DAMPERS[name], np.random.default_rng(1)
    settings = [(x, f, i, warm) for x, f, _ in TESTS for i in CURRENTS for warm in TEMPERATURES]
    records = [bench(damper, x, f, n, i, warm, rng) for x, f, n in TESTS for i in CURRENTS for warm in TEMPERATURES]
    true = {(round(x * f, 4), round(i, 3), warm): cycle(damper, x, f, i, warm) for x, f, i, warm in settings}

    def find(row):
        return true[round(row.speed / (2 * math.pi), 4), round(row.current, 3), row.temperature]

    sheet = characterise(records).sheet
    assert len(sheet.peak_forces) == len(true) and len(sheet.gas_force) == len(CURRENTS) * len(TEMPERATURES)
    for row in sheet.peak_forces:
        size = find(row).peak
        assert row.rebound == pytest.approx(GAS + size, abs=0.005 * (GAS + size))
        assert row.compression == pytest.approx(GAS - size, abs=0.005 * abs(GAS + size))
    for row in sheet.gas_force:
        assert row.force == pytest.approx(GAS, rel=0.01) and row.stiffness == pytest.approx(SPRING, rel=0.01)
    assert [row.force for row in sheet.friction] == pytest.approx([find(row).peak for row in sheet.friction], rel=0.01)
    for row in sheet.energy:
        assert row.energy == pytest.approx(find(row).energy, rel=0.01)
        damping = find(row).energy / (2 * math.pi**2 * row.frequency * row.amplitude**2)
        assert row.damping == pytest.approx(damping, rel=0.01)

    def ask(row, current):
        return find(row._replace(current=current)).peak

    for row in sheet.dynamic_range:
        assert row.both == pytest.approx(ask(row, CURRENTS[-1]) / ask(row, 0.0), rel=0.01)
    for row in sheet.linearity:
        soft, hard = ask(row, 0.0), ask(row, CURRENTS[-1])
        assert row.both == pytest.approx((find(row).peak - soft) / (hard - soft), abs=0.01)
    for row, energy in zip(sheet.hysteresis, sheet.energy, strict=True):
        force, quarter = find(row).force, 5000
        width = abs(force[quarter] - force[3 * quarter] + 2 * SPRING * energy.amplitude)
        assert row.width == pytest.approx(width, abs=0.01 * find(row).peak + NOISE)
