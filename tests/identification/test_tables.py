"""Bench tables: what their names mean, how they are split into records, and what is refused."""

import numpy as np
import pandas as pd
import pytest

from seatsim.recordings.bench_tables import load_bench, meaning
from seatsim.schema.errors import InputError

from .benches import columns, made

TIME = np.arange(100) / 500.0


def plain(**other):
    """Return a table of a still damper, with other columns."""
    table = {"time_s": TIME, "displacement_m": 0.01 * np.sin(6.0 * TIME), "force_N": np.full(100, 5.0)}
    return pd.DataFrame(table | other)


def loaded(folder, table):
    table.to_csv(folder / "one.csv", index=False)
    return load_bench(folder / "one.csv")


@pytest.mark.parametrize(
    "name, quantity, value",
    [
        ("time", "time", 3.0), ("t_ms", "time", 3e-3), ("displacement_mm", "displacement", 3e-3),
        ("Stroke [cm]", "displacement", 0.03), ("velocity (m/s)", "velocity", 3.0), ("speed_mm_s", "velocity", 3e-3),
        ("force_kN", "force", 3e3), ("Damper force (N)", "force", 3.0), ("current_mA", "current", 3e-3),
        ("current_command_A", "command", 3.0), ("voltage_V", "voltage", 3.0), ("command_voltage_mV", "voltage", 3e-3),
        ("temperature_C", "temperature", 3.0), ("Temperature (°C)", "temperature", 3.0),
        ("temperature_K", "temperature", -270.15), ("segment", "segment", 3.0), ("valid", "valid", 3.0),
    ],
)  # fmt: skip
def test_a_name_tells_quantity_and_unit(name, quantity, value):
    known = meaning(name)
    assert known.quantity == quantity and known.in_si(3.0) == pytest.approx(value)


@pytest.mark.parametrize("name", ["f_Hz", "displacement_N", "displacement_cmd_m", "force_cmd_N", "amplitude_m", ""])
def test_other_names_mean_nothing(name):
    assert meaning(name) is None


def test_units_are_turned_into_si(tmp_path):
    record = made(current=0.5, temperature=40.0)
    table = columns(record).assign(temperature_K=313.15)
    (found,) = loaded(tmp_path, table)
    assert found.name == "one, 0.5 A" and found.file == "one.csv" and found.rate == pytest.approx(500.0)
    for name in ("displacement", "velocity", "force", "current", "temperature"):
        np.testing.assert_allclose(getattr(found, name), getattr(record, name), rtol=1e-9, atol=1e-12, err_msg=name)
    assert not found.commanded


def test_a_velocity_is_derived_where_there_is_none(tmp_path):
    record = made(frequency=1.0)
    (found,) = loaded(tmp_path, columns(record).drop(columns="velocity_m_s"))
    middle = slice(20, -20)
    np.testing.assert_allclose(found.velocity[middle], record.velocity[middle], atol=0.002 * np.max(record.velocity))
    (short,) = loaded(tmp_path, plain().iloc[:21].assign(time_s=np.arange(21) / 5000.0))
    assert len(short.velocity) == 21


def test_forces_that_name_their_current_are_records_of_one_motion(tmp_path):
    table = plain().drop(columns="force_N").assign(force_0p2A_N=1.0, force_1p0A_N=2.0)
    first, second = loaded(tmp_path, table)
    assert (first.name, second.name) == ("one, 0.2 A", "one, 1 A")
    assert (first.mean_current, second.mean_current) == (0.2, 1.0)
    assert np.array_equal(first.displacement, second.displacement) and second.force[0] == 2.0


def test_a_record_ends_where_the_segment_changes_and_where_time_jumps(tmp_path):
    segment = np.repeat([0, 1], 50)
    found = loaded(tmp_path, plain(segment=segment, current_A=0.5 * segment))
    assert [(r.name, len(r.force)) for r in found] == [("one, 0 A", 50), ("one, 0.5 A", 50)]
    gap = plain()
    gap.loc[40:, "time_s"] += 1.0
    found = loaded(tmp_path, gap)
    assert [(r.name, len(r.force)) for r in found] == [("one, 0 A, part 1", 40), ("one, 0 A, part 2", 60)]


def test_invalid_rows_are_left_out_whatever_they_hold(tmp_path):
    table = plain(valid=np.where((TIME > 0.08) & (TIME < 0.1), 0, 1))
    table.loc[table.valid == 0, "force_N"] = np.nan
    found = loaded(tmp_path, table)
    assert len(found) == 2 and sum(len(r.force) for r in found) == int(table.valid.sum())


def test_a_voltage_without_a_gain_counts_as_a_command(tmp_path):
    (driven,) = loaded(tmp_path, plain(voltage_V=np.where(TIME > 0.1, 2.0, 0.0)))
    assert driven.commanded and driven.in_volts and np.ptp(driven.current) == 2.0


def test_commands_are_told_from_currents(tmp_path):
    square = np.where(TIME % 0.1 < 0.05, 0.0, 1.0)
    assert loaded(tmp_path, plain(command_A=square))[0].commanded
    assert not loaded(tmp_path, plain(current_A=square))[0].commanded
    assert not loaded(tmp_path, plain(command_A=1.0))[0].commanded, "a coil has long settled on a constant command"
    (both,) = loaded(tmp_path, plain(command_A=square, coil_current_A=0.5 * square - 0.1))
    assert not both.commanded and both.current.min() == 0.0 and both.current.max() == pytest.approx(0.4)


RECORDING = """\
rig: {rig}
sample_rate: 500.0
nominal: nominal.yaml
runs: [{{name: run-a, file: run-a.csv}}]
channels: {{displacement: {{unit: m}}, damper_force: {{unit: N}}, command_voltage: {{unit: V}}}}
actuator: {{gain: 0.5}}
"""


def test_a_recording_of_a_bench_is_read_as_it_says(tmp_path):
    (tmp_path / "recording.yaml").write_text(RECORDING.format(rig="damper_bench"))
    voltage = np.where(TIME > 0.1, 2.0, 0.0)
    table = pd.DataFrame({"displacement": 0.01 * TIME, "damper_force": 5.0 + TIME, "command_voltage": voltage})
    table.to_csv(tmp_path / "run-a.csv", index=False)
    (found,) = load_bench(tmp_path)
    assert found.name == "run-a" and found.commanded and found.current.max() == 1.0 and not found.in_volts
    assert found.velocity[50] == pytest.approx(0.01)
    text = (tmp_path / "recording.yaml").read_text()
    nominal = "damper: {model: modified_bouc_wen}\nactuator: {rate: 130.0, max_current: 1.0}\ntemperature: 20.0\n"
    (tmp_path / "nominal.yaml").write_text(nominal)
    (tmp_path / "recording.yaml").write_text(text.replace("run-a.csv", "run-a.csv, set: {temperature: 50.0}"))
    with pytest.raises(InputError, match="run run-a sets temperature; one damper, as it is, is identified"):
        load_bench(tmp_path)
    text = text.replace("displacement: {unit: m}", "floor_acceleration: {unit: m/s^2}").replace("damper_bench", "seat")
    text = text.replace("command_voltage: {unit: V}", "coil_current: {unit: A}")
    (tmp_path / "recording.yaml").write_text(text)
    with pytest.raises(InputError, match=r"rig 'seat' with floor_acceleration.* 'rig: damper_bench'"):
        load_bench(tmp_path)


def uneven():
    return plain().assign(time_s=TIME + TIME**2)


def jumping():
    return plain().assign(time_s=np.where(np.arange(100) % 3 == 2, TIME + 0.0015, TIME))


@pytest.mark.parametrize(
    "table, problem",
    [
        (plain().drop(columns="displacement_m").assign(displacment_m=0.0),
         "column 'displacment_m' is not known; name it 'displacement_m' or 'displacement_mm'"),
        (plain().drop(columns="displacement_m").assign(disp_mm=0.0),
         "no column holds the displacement (did you mean 'disp_mm'?); name it 'displacement_m' or 'displacement_mm'"),
        (plain().drop(columns="force_N").assign(force_filtered=0.0),
         "no column holds the force (did you mean 'force_filtered'?); name it 'force_N' or 'force_kN'"),
        (plain().drop(columns="time_s"), "no column holds the time"),
        (plain(curent_A=1.0), "column 'curent_A' is not known; name it 'current_A' or 'current_mA'"),
        (plain(temperature_degX=70.0), "column 'temperature_degX' is not known; name it 'temperature_degC' or"),
        (plain(stroke_mm=1.0), "'displacement_m' and 'stroke_mm' both hold the displacement"),
        (plain(damper_force_kN=1.0), "'force_N' and 'damper_force_kN' both hold the force"),
        (plain(temperature_C=["warm"] * 100), "line 2, temperature_C: 'warm' (and 99 more rows) is not"),
        (plain(current_A=np.where(TIME == 0.05, np.nan, 1.0)), "line 27, current_A: 'nan' is not a finite"),
        (plain().iloc[:7], "holds 7 rows of rising time; a record has at least 20"),
        (plain().assign(time_s=0.0), "100 rows of rising time"),
        (uneven(), "are not evenly spaced in time; resample them"),
        (jumping(), "line 4, 0.0055 s: rows are not evenly spaced in time"),
    ],
)  # fmt: skip
def test_a_bad_table_is_refused_at_its_place(table, problem, tmp_path):
    with pytest.raises(InputError) as error:
        loaded(tmp_path, table)
    assert problem in str(error.value) and "one." in str(error.value)


def test_missing_and_empty_places_are_refused(tmp_path):
    (tmp_path / "sines").mkdir()
    with pytest.raises(InputError, match=r"sine: no such file or folder \(did you mean 'sines'\?\); give"):
        load_bench(tmp_path / "sine")
    with pytest.raises(InputError, match=r"sines: holds no table; give a folder with files that end in \.csv"):
        load_bench(tmp_path / "sines")
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "no.csv.gz").write_text("not compressed")
    for name in ("empty.csv", "no.csv.gz"):
        with pytest.raises(InputError, match=f"{name}: cannot be read as a table"):
            load_bench(tmp_path / name)
