"""Cycles of measured records: what is cut, what is left out, and the figures of a known damper."""

import math

import numpy as np
import pytest

from seatsim.characterisation.rows import find_cycles, select_steady_cycles, summarise_record
from seatsim.characterisation.summary import characterise
from seatsim.dampers.bingham import Bingham

FRICTION = Bingham(c_a=300.0, c_b=200.0, fc_a=50.0, fc_b=400.0, f0=30.0, v_ref=0.0)


def test_energy_damping_and_offset_of_a_bingham_damper(record, sine):
    # 4 fc X from friction, pi c w X^2 from the dashpot; at 0.5 A fc = 250 N, c = 400 N s/m
    motion, seconds = sine(0.01, 2.0)
    row = summarise_record(record(motion, seconds, lambda t: 0.5 + 0.0 * t, FRICTION, noise=2.0))
    w = 4.0 * math.pi
    energy = 4.0 * 250.0 * 0.01 + math.pi * 400.0 * w * 0.01**2
    assert row.cycles == 8 and row.left_out == 2
    assert row.amplitude == pytest.approx(0.01, rel=2e-3) and row.frequency == pytest.approx(2.0, rel=1e-3)
    assert row.peak_speed == pytest.approx(0.01 * w, rel=5e-3)
    assert row.energy == pytest.approx(energy, rel=3e-3) and row.energy_sd < 0.01 * energy
    assert row.damping == pytest.approx(energy / (math.pi * w * 0.01**2), rel=5e-3)
    assert row.offset == pytest.approx(30.0, abs=1.0)
    assert row.peak_rebound == pytest.approx(280.0 + 400.0 * 0.01 * w, abs=8.0)
    assert row.current == 0.5 and math.isnan(row.temperature) and row.notes == ()


@pytest.mark.parametrize("kind", ["chirp", "random", "still", "one cycle"])
def test_what_is_not_cyclic_is_told(record, kind):
    t = np.linspace(0.0, 8.0, 4000)
    walk = np.cumsum(np.random.default_rng(3).standard_normal(400))
    motion = {
        "chirp": lambda t: 0.004 * np.sin(2.0 * math.pi * (0.5 * t + 0.6 * t**2)),
        "random": lambda t: 1e-3 * np.interp(t, np.linspace(0.0, 8.0, 400), walk),
        "still": lambda t: 0.0 * t,
        "one cycle": lambda t: 0.004 * np.sin(2.0 * math.pi * t / 7.0),
    }[kind]
    assert select_steady_cycles(find_cycles(motion(t))) == []
    row = summarise_record(record(motion, 8.0))
    assert row.cycles == 0 and math.isnan(row.energy)
    assert row.notes[0].startswith("not cyclic") and math.isfinite(row.peak_rebound)


def test_a_force_of_the_wrong_sign_and_a_velocity_of_the_wrong_unit_are_told(record, sine):
    motion, seconds = sine(0.01, 2.0)
    made = record(motion, seconds)
    assert "other way round" in summarise_record(made._replace(force=-made.force)).notes[-1]
    assert "disagree" in summarise_record(made._replace(velocity=1.2 * made.velocity)).notes[0]


def test_measured_sines(shared):
    from seatsim.recordings.bench_tables import load_bench

    found = characterise(load_bench(shared / "data" / "utfsm_mr_sine_raw"), "sines")
    assert len(found.rows) == 30 and all(row.cycles >= 4 for row in found.rows) and not found.responses
    strongest = next(row for row in found.rows if row.record == "raw_10mm_2Hz, 1 A")
    assert strongest.peak_rebound == pytest.approx(1667.0, abs=15.0)
    assert strongest.energy == pytest.approx(57.2, rel=0.01)
    assert all(20.0 < row.offset < 60.0 for row in found.rows)
    swept = characterise(load_bench(shared / "data" / "utfsm_mr_chirp"), "chirps")
    assert all(row.cycles == 0 for row in swept.rows)


def test_a_damaged_record_is_named_and_a_drifting_zero_bends_no_loop(record, sine):
    motion, seconds = sine(0.015, 1.0)
    made = record(motion, seconds, lambda t: 0.5 + 0.0 * t, FRICTION, noise=2.0)
    clean = summarise_record(made)
    assert clean.notes == ()
    top = 0.8 * np.max(made.force)
    assert "force: " in (note := summarise_record(made._replace(force=np.minimum(made.force, top))).notes[0])
    assert "it is clipped" in note
    lost = made.force.copy()
    lost[3000:3100] = 0.0
    assert "a dropout" in summarise_record(made._replace(force=lost)).notes[0]
    assert "volts stand in place of amperes" in summarise_record(made._replace(in_volts=True)).notes[0]
    drifting = summarise_record(made._replace(force=made.force + 10.0 * made.time))
    assert "the mean force drifts by +" in drifting.notes[0]
    assert drifting.energy == pytest.approx(clean.energy, rel=1e-3)
