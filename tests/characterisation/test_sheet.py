"""The tables of a bench day are those of the damper that was tested, computed apart."""

import json
import math
import shutil

import numpy as np
import openpyxl
import pandas as pd
import pytest

from seatsim.characterisation.summary import characterise
from seatsim.dampers.bingham import Bingham
from seatsim.recordings.bench_tables import NAMED, BenchRecord, load_bench
from seatsim.rig.coil import Coil, relax
from seatsim.schema.content import to_content
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import bench_force

RATE, GAS, SPRING, NOISE, DRIFT, FADE = 2000.0, 60.0, 500.0, 2.0, 0.2, -0.004
DAMPER = Bingham(c_a=250.0, c_b=350.0, fc_a=45.0, fc_b=620.0, v_ref=0.01)
TESTS = ((0.01, 0.5), (0.02, 2.0))
"""Amplitudes in m with frequencies in Hz."""


def force_of(v, current, temperature=20.0):
    """The force of the damper without its gas, as its equation says."""
    yielding = (DAMPER.fc_a + DAMPER.fc_b * current) * np.tanh(v / DAMPER.v_ref)
    return (1.0 + FADE * (temperature - 20.0)) * ((DAMPER.c_a + DAMPER.c_b * current) * v + yielding)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder of tests, twice each, whose names alone say current and temperature; with noise and a drifting zero."""
    place, rng = tmp_path_factory.mktemp("day"), np.random.default_rng(0)
    for current in (0.0, 0.5, 1.0):
        for warm in (20.0, 60.0):
            for number in (1, 2):
                for x, f in TESTS:
                    time = np.arange(round(RATE * max(3.0, 4.0 / f))) / RATE
                    moved, v = x * np.sin(2 * np.pi * f * time), 2 * np.pi * f * x * np.cos(2 * np.pi * f * time)
                    force = force_of(v, current, warm) + GAS + SPRING * moved
                    force += NOISE * rng.standard_normal(len(time)) + DRIFT * (time - time.mean())
                    table = pd.DataFrame({"time_s": time, "displacement_mm": 1e3 * moved, "force_N": force})
                    table.to_csv(place / f"{f:g}Hz_{current:g}A-{warm:g}C-{number}.csv", index=False)
    return place


@pytest.fixture(scope="module")
def sheet(folder):
    return characterise(load_bench(folder, NAMED)).sheet


def test_forces_are_within_half_a_per_cent_and_repeats_are_averaged(sheet):
    assert len(sheet.peak_forces) == 12
    for row in sheet.peak_forces:
        true = force_of(row.speed, row.current, row.temperature)
        assert row.rebound == pytest.approx(GAS + true, abs=0.005 * true + 0.5)
        assert row.compression == pytest.approx(GAS - true, abs=0.005 * true + 0.5)
        assert row.repeats == 2 and 0.0 <= row.spread < NOISE


def test_tables_that_are_read_side_by_side_give_what_their_records_give(folder, sheet):
    told = []
    found = characterise(folder, pattern=NAMED, progress=told.append)
    assert to_content(found.sheet) == to_content(sheet) and len(told) == len(list(folder.iterdir())) == 24


def test_gas_and_friction_are_told_apart(sheet):
    for gas, friction in zip(sheet.gas_force, sheet.friction, strict=True):
        assert (gas.current, gas.temperature) == (friction.current, friction.temperature)
        assert gas.force == pytest.approx(GAS, abs=0.5) and gas.stiffness == pytest.approx(SPRING, rel=0.015)
        assert friction.force == pytest.approx(force_of(gas.speed, gas.current, gas.temperature), rel=0.01)


def test_ratios_are_those_of_the_equation(sheet):
    for row in sheet.dynamic_range:
        assert row.current == 1.0
        expected = force_of(row.speed, 1.0, row.temperature) / force_of(row.speed, 0.0, row.temperature)
        assert row.both == pytest.approx(expected, rel=0.01)
    assert all(row.both == pytest.approx(row.current, abs=0.005) for row in sheet.linearity)
    assert len(sheet.linearity) == 12 and len(sheet.dynamic_range) == 4
    assert all(row.per_kelvin == pytest.approx(FADE, rel=0.02) for row in sheet.fade)
    assert len(sheet.fade) == 6


def test_energy_is_the_area_and_hysteresis_the_width_of_the_loop(sheet):
    phase = np.linspace(0.0, 2 * np.pi, 4001)
    for energy, width in zip(sheet.energy, sheet.hysteresis, strict=True):
        v = energy.speed * np.cos(phase)
        work = force_of(v, energy.current, energy.temperature) * v
        expected = np.trapezoid(work, phase) / (2 * np.pi * energy.frequency)
        assert energy.energy == pytest.approx(expected, rel=0.01)
        # Without hysteresis the spring alone tells the two ends of a stroke, and the halves of a cycle, apart.
        assert width.width == pytest.approx(2 * SPRING * energy.amplitude, abs=0.03 * GAS + 8.0)


def there_and_back():
    """Eight seconds at 0.1 m/s over 40 mm, out and back: time, displacement, velocity."""
    time = np.arange(round(8.0 * RATE)) / RATE
    phase = (time / 0.4) % 2
    return time, 0.04 * (np.where(phase < 1, phase, 2 - phase) - 0.5), np.where(phase < 1, 0.1, -0.1)


def test_responses_count_from_the_current(tmp_path):
    time, x, v = there_and_back()
    coil, command = Coil(rate=130.0, rate_fall=80.0), np.where((time + 0.2) % 0.8 < 0.4, 0.0, 1.0)
    current = np.array(command)
    for k in range(1, len(current)):
        current[k] = relax(coil, current[k - 1], command[k - 1], 1.0 / RATE)
    fine = np.repeat(x, 2)[:-1], np.repeat(v, 2)[:-1], np.repeat(current, 2)[:-1]
    rng = np.random.default_rng(1)
    force = bench_force(DAMPER, *fine, 20.0, 1.0 / RATE) + GAS + SPRING * x + NOISE * rng.standard_normal(len(x))
    columns = {"time_s": time, "displacement_m": x, "velocity_m_s": v, "force_N": force, "coil_current_A": current}
    pd.DataFrame(columns).to_csv(tmp_path / "steps.csv", index=False)
    rows = characterise(tmp_path).sheet.response
    steps = [(round(row.before), round(row.after), row.direction) for row in rows]
    assert steps == [(0, 1, "rebound"), (1, 0, "compression")]
    for row, rate in zip(rows, (130.0, 80.0), strict=True):
        begun = math.log(1 / 0.9) / rate
        assert row.t10 == pytest.approx(0.0, abs=5e-4) and row.start == pytest.approx(0.0, abs=1e-3)
        assert row.t63 == pytest.approx(1 / rate - begun, abs=5e-4)
        assert row.t90 == pytest.approx(math.log(10) / rate - begun, abs=5e-4)
        assert row.settling == pytest.approx(math.log(20) / rate - begun, abs=2e-3)
        assert row.overshoot < 0.01 and row.recovery < 1e-3 and row.speed == pytest.approx(0.1)


LIMITS = """\
limits:
  dynamic_range: {min: 2.0}
  friction: {max: 100.0}
  t90_up: {max: 0.025}
"""


def test_the_command_judges_limits_and_writes_a_workbook(folder, tmp_path, seatsim_command):
    (tmp_path / "limits.yaml").write_text(LIMITS)
    (tmp_path / "cold").mkdir()
    for path in folder.glob("*_[01]A-20C-*.csv"):
        shutil.copy(path, tmp_path / "cold")
    beside = tmp_path / "damper.yaml"
    beside.write_text(f"model: bingham\nparameters: {DAMPER._asdict()}\n")
    arguments = ("--limits", tmp_path / "limits.yaml", "--beside", beside, "--window", "0.1")
    status, printed, said = seatsim_command("characterise", tmp_path / "cold", *arguments, "--out", tmp_path / "out")
    assert status == 0 and "min 2: pass" in printed and "t90_up: not determined, max 0.025: FAIL" in said
    found = json.loads((tmp_path / "out" / "characterisation.json").read_text())
    checks = {row["name"]: row for row in found["limits"]}
    assert checks["dynamic_range"]["pass"] and checks["dynamic_range"]["value"] > 2.0
    assert not checks["friction"]["pass"] and checks["friction"]["value"] > checks["friction"]["limit"] == 100.0
    assert not checks["t90_up"]["pass"] and checks["t90_up"]["value"] is None
    for row in found["beside"]:
        assert row["rebound"] == pytest.approx(force_of(row["speed"], row["current"]), rel=0.005)
    book = openpyxl.load_workbook(tmp_path / "out" / "characterisation.xlsx")
    assert book.sheetnames[:2] == ["peak_forces", "response"]
    head, first = list(book["peak_forces"].values)[:2]
    assert head[:4] == ("current [A]", "temperature [degC]", "speed [m/s]", "rebound [N]")
    assert list(first) == [pytest.approx(each) for each in found["peak_forces"][0].values()]
    assert next(book["response"].values)[:2] == ("from [A]", "to [A]")
    # The workbook of the same day has the same bytes, as all files.
    assert seatsim_command("reproduce", tmp_path / "out")[0] == 0
    assert "Worst figure against each limit" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("limits: {t90_upp: {max: 1}}", "line 1, limits.t90_upp: unknown key (did you mean 't90_up'?)"),
        ("limits: {friction: {most: 1}}", "limits.friction.most: unknown key; permitted: min, max"),
        ("limits: {friction: {max: much}}", "'much' is not permitted; it must be a finite number"),
        ("limit: {friction: {max: 1}}", "unknown key (did you mean 'limits'?)"),
    ],
)
def test_a_wrong_limit_is_one_clear_error(folder, tmp_path, seatsim_command, text, expected):
    (tmp_path / "limits.yaml").write_text(text)
    options = ("--limits", tmp_path / "limits.yaml", "--out", tmp_path / "out")
    status, out, err = seatsim_command("characterise", min(folder.iterdir()), *options)
    assert status == 2 and expected in " ".join((out + err).split()) and not (tmp_path / "out").exists()


def test_a_pattern_reads_the_names_of_files(folder):
    found = load_bench(folder, r"_(?P<current>[\d.]+)A")
    assert {record.mean_current for record in found} == {0.0, 0.5, 1.0} and found[0].temperature is None
    assert {record.mean_current for record in load_bench(folder)} == {0.0}
    with pytest.raises(InputError, match="is no regular expression"):
        load_bench(folder, "(")
    with pytest.raises(InputError, match="has no group named current or temperature"):
        load_bench(folder, r"(\d)A")
    with pytest.raises(InputError, match="finds no number in"):
        load_bench(folder, r"(?P<current>Hz)")


def cycle_at(rate, seconds, force, current):
    """A record of ±10 mm at 2 Hz; `force` is a function of velocity and time, `current` one of time."""
    time = np.arange(round(rate * seconds)) / rate
    x, v = 0.01 * np.sin(4 * np.pi * time), 0.04 * np.pi * np.cos(4 * np.pi * time)
    return BenchRecord("test", "test.csv", rate, x, v, force(v, time) + GAS, current(time), False, None)


def test_a_record_that_warms_up_has_a_fade_of_its_own():
    made = cycle_at(500.0, 40.0, lambda v, t: 1000.0 * (1.0 + FADE * 0.5 * t) * v, lambda t: 0.5 + 0.0 * t)
    (fade,) = characterise([made._replace(temperature=20.0 + 0.5 * made.time)]).sheet.fade
    assert fade.record == "test" and (fade.coldest, fade.warmest) == pytest.approx((20.1, 39.9), abs=0.3)
    assert fade.per_kelvin == pytest.approx(FADE, rel=0.01)
    assert characterise([made]).sheet.fade == []


def test_overshoot_of_the_force_and_recovery_are_not_those_of_the_current():
    time, x, v = there_and_back()
    since = (time + 0.2) % 0.4
    raised = (time + 0.2) % 0.8 >= 0.4
    # An oscillation of the coil's controller: peak exp(-pi d / sqrt(1 - d^2)) with a damping d of 0.5 at 40 Hz.
    w, d = 80.0 * np.pi, 0.5
    wd = w * math.sqrt(1.0 - d * d)
    share = 1.0 - np.exp(-d * w * since) * (np.cos(wd * since) + d * w / wd * np.sin(wd * since))
    # The force follows a current that dips: 95 % after 10 ms, 80 % from 30 to 50 ms, all from 60 ms on.
    shape = np.interp(since, [0.0, 0.01, 0.02, 0.03, 0.05, 0.06], [0.0, 0.95, 0.95, 0.8, 0.8, 1.0])
    current, follows = np.where(raised, share, 1.0 - share), np.where(raised, shape, 1.0 - shape)
    force = (100.0 + 500.0 * follows) * np.sign(v) + GAS
    record = BenchRecord("steps", "steps.csv", RATE, x, v, force, current, False, None)
    rows = characterise([record]).sheet.response
    assert len(rows) == 2
    for row in rows:
        assert row.overshoot < 0.01
        assert row.recovery == pytest.approx(0.055 - 0.01 * 90 / 95, abs=1e-3)
