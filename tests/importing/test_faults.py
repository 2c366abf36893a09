"""Faults of units, signs and offsets that no map mends: each is found, named, and not corrected."""

import numpy as np
import pandas as pd
import pytest

import seatsim
from seatsim.importing.importing import import_files
from seatsim.schema.errors import InputError

from .helpers import kinds, read_run, write_csv

G = 9.80665
ACCELERATIONS = ("floor_acceleration", "frame_acceleration", "driver_acceleration")


def scaled(factor, offset=0.0):
    return lambda values: factor * values + offset


FAULTS = {
    **{f"{name} in g": ({name: scaled(1 / G)}, name, "unit") for name in ACCELERATIONS},
    "frame in mm/s^2": ({"frame_acceleration": scaled(1000.0)}, "frame_acceleration", "unit"),
    **{f"{name} swapped": ({name: scaled(-1.0)}, name, "sign") for name in ACCELERATIONS},
    "frame with gravity": ({"frame_acceleration": scaled(1.0, 9.81)}, "frame_acceleration", "gravity"),
    "gravity downwards": ({"floor_acceleration": scaled(1.0, -9.81)}, "floor_acceleration", "gravity"),
    "gravity in g": ({"driver_acceleration": scaled(1 / G, 1.0)}, "driver_acceleration", "unit"),
    "all with gravity": (dict.fromkeys(ACCELERATIONS, scaled(1.0, 9.81)), "frame_acceleration", "gravity"),
    "all in g": (dict.fromkeys(ACCELERATIONS, scaled(1 / G)), "floor_acceleration", "unit"),
    "all swapped": (dict.fromkeys(ACCELERATIONS, scaled(-1.0)), "floor_acceleration", "sign"),
    "offset of the floor": ({"floor_acceleration": scaled(1.0, 1.5)}, "floor_acceleration", "offset"),
    "travel in mm": ({"suspension_displacement": scaled(1000.0)}, "suspension_displacement", "unit"),
    "travel in cm": ({"suspension_displacement": scaled(100.0)}, "suspension_displacement", "unit"),
    "travel swapped": ({"suspension_displacement": scaled(-1.0)}, "suspension_displacement", "sign"),
    "travel with an offset": ({"suspension_displacement": scaled(1.0, 0.02)}, "suspension_displacement", "offset"),
    "force in kN": ({"damper_force": scaled(1e-3)}, "damper_force", "unit"),
    "force swapped": ({"damper_force": scaled(-1.0)}, "damper_force", "sign"),
    "force with an offset": ({"damper_force": scaled(1.0, 80.0)}, "damper_force", "offset"),
    "command in mA": ({"current_command": scaled(1000.0)}, "current_command", "unit"),
    "coil in mA": ({"coil_current": scaled(1000.0)}, "coil_current", "unit"),
    "coil swapped": ({"coil_current": scaled(-1.0)}, "coil_current", "sign"),
    "temperature in K": ({"damper_temperature": scaled(1.0, 273.15)}, "damper_temperature", "unit"),
    "temperature in degF": ({"damper_temperature": scaled(1.8, 32.0)}, "damper_temperature", "unit"),
}
"""What is done to channels, in which channel it is to be found, and as what."""


@pytest.fixture(scope="module")
def warm_table(noisy_table):
    generator = np.random.default_rng(7)
    rows = len(noisy_table["time"])
    warm = 20.0 + np.linspace(0, 1, rows) + 0.05 * generator.standard_normal(rows)
    return {**noisy_table, "damper_temperature": warm}


def import_table(folder, table, *options):
    """Import a table, with a map and a nominal scenario where they are given, into `out`."""
    pd.DataFrame(table).to_feather(folder / "a.feather")
    return import_files([folder / "a.feather"], folder / "out", *options)


def spoil(table, name):
    """Return a table with a fault."""
    return {key: FAULTS[name][0].get(key, scaled(1.0))(values) for key, values in table.items()}


def test_a_sound_recording_raises_no_warning_but_what_is_so(warm_table, tmp_path):
    found = import_table(tmp_path, warm_table)
    assert {issue.kind for issue in found.doubts if issue.severity != "note"} <= {"held"}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named_and_left_as_it_is(warm_table, tmp_path, name):
    table, (_, channel, kind) = spoil(warm_table, name), FAULTS[name]
    found = import_table(tmp_path, table)
    assert kind in kinds(found.doubts, channel)
    assert any(channel in issue.sentence for issue in found.doubts if issue.kind == kind)
    got = read_run(tmp_path / "out")[channel]
    np.testing.assert_allclose(got, table[channel], rtol=1e-6, atol=1e-6 * np.std(table[channel]))


@pytest.mark.parametrize("name", ["travel swapped", "all in g", "temperature in K"])
def test_with_a_nominal_what_gap_and_diagnose_refuse_is_said_at_once(warm_table, tmp_path, nominal, name):
    found = import_table(tmp_path, spoil(warm_table, name), None, nominal)
    assert FAULTS[name][2] in {issue.kind for issue in found.doubts if issue.severity == "error"}
    with pytest.raises(InputError):
        seatsim.gap(tmp_path / "out" / "nominal.yaml", tmp_path / "out")


def test_time_in_ms_is_asked_for_where_no_unit_is_stated_and_doubted_where_a_wrong_one_is(noisy_table, tmp_path):
    path = write_csv(tmp_path / "a.csv", {**noisy_table, "time": 1000.0 * noisy_table["time"]})
    with pytest.raises(InputError, match="'time' has no unit, and its rows are 2 apart"):
        import_files([path], tmp_path / "out")
    stated = tmp_path / "out" / "map.yaml"
    text = stated.read_text()
    assert "time: {column: time, unit: ''}" in text
    stated.write_text(text.replace("unit: ''}", "unit: s}", 1))
    assert "rate" in kinds(import_files([path], tmp_path / "wrong", stated).doubts)
    stated.write_text(text.replace("unit: ''}", "unit: ms}", 1))
    right = import_files([path], tmp_path / "right", stated)
    assert right.rate == 500.0
    assert "rate" not in kinds(right.doubts)


def test_the_map_mends_what_it_states(warm_table, tmp_path):
    table = {**warm_table, "floor_acceleration": -(warm_table["floor_acceleration"] + 9.81) / G}
    stated = tmp_path / "map.yaml"
    entry = "{column: floor_acceleration, unit: g, sign: -1, remove_mean: true, noise_rms: 0.01}"
    stated.write_text(f"time: {{column: time, unit: s}}\nchannels: {{floor_acceleration: {entry}}}\n")
    found = import_table(tmp_path, table, stated)
    assert not kinds(found.doubts) & {"gravity", "offset", "unit", "sign"}
    expected = warm_table["floor_acceleration"] - np.mean(warm_table["floor_acceleration"])
    np.testing.assert_allclose(read_run(tmp_path / "out")["floor_acceleration"], expected, atol=1e-6)
    assert "noise_rms: 0.01" in (tmp_path / "out" / "recording.yaml").read_text()


def test_a_delay_is_taken_off(warm_table, tmp_path):
    late = {**warm_table, "damper_force": np.roll(warm_table["damper_force"], 25)}
    stated = tmp_path / "map.yaml"
    stated.write_text(
        "time: {column: time, unit: s}\nchannels:\n  floor_acceleration: {column: floor_acceleration}\n"
        "  damper_force: {column: damper_force, delay: 0.05}\n"
    )
    import_table(tmp_path, late, stated)
    got = read_run(tmp_path / "out")["damper_force"].to_numpy()
    np.testing.assert_allclose(got[:4900], warm_table["damper_force"][:4900], rtol=1e-6, atol=1e-6)
