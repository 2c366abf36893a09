"""The commands import and inspect, as a shell calls them."""

import json

import numpy as np
import pytest
from ruamel.yaml import YAML

from ..text import words
from .conftest import RECORDING
from .helpers import write_csv


def test_import_shows_its_map_and_writes_a_recording(noisy_table, tmp_path, seatsim_command):
    path = write_csv(tmp_path / "a.csv", noisy_table)
    status, said, _ = seatsim_command("import", path, "--out", tmp_path / "out")
    assert status == 0
    assert "proposed map" in said
    assert "driver_acceleration: {column: driver_acceleration, unit: m/s^2, sign: 1}" in said
    assert "import with --nominal" in said
    header = YAML(typ="safe").load(tmp_path / "out" / "recording.yaml")
    assert header["sample_rate"] == 500.0
    assert header["rig"] == "seat"
    files = words("recording.yaml map.yaml run-a.csv.gz manifest.json")
    assert {each.name for each in (tmp_path / "out").iterdir()} == set(files)


def test_a_nominal_without_a_current_is_asked_for_one(noisy_table, tmp_path, seatsim_command):
    table = {name: noisy_table[name] for name in ("time", "floor_acceleration", "driver_acceleration")}
    path = write_csv(tmp_path / "a.csv", table)
    words = ("import", path, "--out", tmp_path / "out", "--nominal", RECORDING / "nominal.yaml")
    status, _, err = seatsim_command(*words)
    assert status == 2 and "no current was recorded" in err
    assert not (tmp_path / "out").exists()


def test_inspect_shows_channels_and_doubts(noisy_table, tmp_path, seatsim_command):
    table = {**noisy_table, "driver_acceleration": noisy_table["driver_acceleration"] + 9.81}
    path = write_csv(tmp_path / "a.csv", {**table, "a_Sitz [g]": np.sin(np.arange(5001))})
    _, out, err = seatsim_command("inspect", path)
    assert "suspension_displacement" in out and "a_Sitz" in out and "is gravity" in err
    told = json.loads(seatsim_command("inspect", path, "--json")[1])
    assert {each["name"] for each in told["channels"]} >= set(noisy_table) - {"time"}
    assert "gravity" in {each["kind"] for each in told["doubts"]}


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("floor_acceleration: {column: a, unit: kN}", "line 2, channels.floor_acceleration.unit: 'kN' is no unit"),
        ("floor_acceleration: {column: a, sgn: 1}", "did you mean 'sign'"),
        ("damper_force: {column: a}", "channel 'floor_acceleration' is missing"),
        ("floor_acceleration: {column: a}", ""),
    ],
)
def test_check_reads_a_map(tmp_path, seatsim_command, entry, said):
    stated = tmp_path / "map.yaml"
    stated.write_text(f"channels:\n  {entry}\n")
    status, out, err = seatsim_command("check", stated)
    assert status == (2 if said else 0) and said in err and ("map of a seat" in out) == (not said)


def test_names_of_others_are_shown_and_not_obeyed(noisy_table, tmp_path, seatsim_command):
    table = {"time": noisy_table["time"], ":smile: [/b] =1+1 [g]": noisy_table["floor_acceleration"]}
    path = write_csv(tmp_path / "a:smile:\x1b[31m[b].csv", table)
    said = seatsim_command("inspect", path)[1]
    assert "a:smile:\\x1b[31m[b].csv" in said and ":smile: [/b] =1+1" in said and "\x1b" not in said
