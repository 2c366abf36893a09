"""Data that nobody here wrote: every file is imported with at most a ten-line map, and its quirks are found."""

import pytest

from seatsim.importing.importing import import_files
from seatsim.importing.inspection import inspect_file

BENCH = """\
rig: damper_bench
time: {column: time_s, unit: s}
gaps: split
channels:
  displacement: {column: displacement_m, unit: m}
  damper_force: {column: force_N, unit: "N"}
  coil_current: {column: current_A, unit: A}
"""
MAPS = {
    "utfsm_mr_sine_raw": BENCH, "utfsm_mr_sine_preprocessed": BENCH,
    "utfsm_mr_earthquake": """\
time: {column: time_s, unit: s}
channels:
  displacement: {column: displacement_m, unit: m}
  damper_force: {column: force_0p6A_N, unit: "N"}
  coil_current: {value: 0.6, unit: A}
""",
    "dyke_nees_2012_1158": """\
time: {column: time_s, unit: s}
actuator: {gain: 0.4444}
resample: 751.2
channels:
  displacement: {column: displacement_m, unit: m}
  damper_force: {column: force_N, unit: "N"}
  command_voltage: {column: voltage_V, unit: V}
""",
    "bus_floor": """\
time: {column: time_s, unit: s}
channels: {floor_acceleration: {column: acc_z_m_s2, unit: m/s^2, remove_mean: true}}
""",
    "quanser_active_suspension": """\
time: {column: time_s, unit: s}
resample: 50
channels:
  floor_acceleration: {column: road_displacement_m, unit: m, differentiate: 2}
  frame_acceleration: {column: unsprung_displacement_m, unit: m, differentiate: 2}
  driver_acceleration: {column: sprung_displacement_m, unit: m, differentiate: 2}
  suspension_displacement: {column: unsprung_displacement_m, minus: road_displacement_m, unit: m}
""",
}  # fmt: skip
"""Maps by folder; the files of the others need none."""
QUIRKS = {
    "bus_floor/L3_Pionierska_RacianskeMyto": {("acc_z_m_s2", "gravity")},
    "fsae_damper_temperature/t2_3_3_24_24_s5_n100_100psi_with_heat_gun": {("temperature_C", "warming")},
    "quanser_active_suspension/chirp_A_rep1": {
        ("unsprung_displacement_m", "resolution"), ("force_cmd_N", "command"), ("road_displacement_m", "zeroed"),
    },
    "utfsm_mr_sine_raw/raw_2mm_5Hz": {("force_N", "relaxation"), ("displacement_m", "zeroed")},
    "utfsm_mr_chirp/chirp15Hz_0p5A": {
        ("current_A", "constant"), ("displacement_m", "late"), ("velocity_m_s", "derived"), ("force_N", "resolution"),
    },
    "utfsm_mr_sine_preprocessed/pre_10mm_1Hz": {
        ("time_s", "restart"), ("force_N", "centred"), ("force_N", "smooth"), ("current_A", "levels"),
    },
    "utfsm_mr_sine_raw/raw_10mm_2Hz": {
        ("time_s", "gap"), ("current_A", "levels"), ("force_N", "offset"), ("force_N", "resolution"),
        ("velocity_m_s", "derived"),
    },
}  # fmt: skip
"""What the descriptions of the data say of them, by channel; every kind of quirk is in one of them."""


@pytest.mark.slow
def test_every_file_is_imported_with_a_short_map(shared, tmp_path):
    files = [path for path in sorted((shared / "data").glob("*/*.csv.gz")) if path.parent.name != "roads"]
    assert len(files) >= 20
    for path in files:
        text = MAPS.get(path.parent.name)
        stated = tmp_path / "map.yaml" if text else None
        if text and stated:
            assert len(text.splitlines()) <= 10
            stated.write_text(text)
        folder = tmp_path / path.name.partition(".")[0]
        import_files([path], folder, stated)
        assert (folder / "recording.yaml").exists()


@pytest.mark.parametrize("name", QUIRKS)
def test_the_quirks_that_a_description_states_are_found(shared, name):
    found = inspect_file(shared / "data" / f"{name}.csv.gz")
    assert QUIRKS[name] <= {(issue.channel, issue.kind) for issue in found.doubts}
