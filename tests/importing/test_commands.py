"""The commands import and inspect, as a shell calls them."""

import json
import sys

import numpy as np
import pytest
from ruamel.yaml import YAML

from seatsim.cli.app import main

from .conftest import RECORDING
from .helpers import write_csv


def call(monkeypatch, *words):
    """Call the command line and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["seatsim", *map(str, words)])
    with pytest.raises(SystemExit) as done:
        main()
    return done.value.code or 0


def test_import_shows_its_map_and_writes_a_recording(noisy_table, tmp_path, monkeypatch, capsys):
    path = write_csv(tmp_path / "a.csv", noisy_table)
    assert call(monkeypatch, "import", path, "--out", tmp_path / "out") == 0
    said = capsys.readouterr().out
    assert "proposed map" in said
    assert "driver_acceleration: {column: driver_acceleration, unit: m/s^2, sign: 1}" in said
    assert "import with --nominal" in said
    header = YAML(typ="safe").load(tmp_path / "out" / "recording.yaml")
    assert header["sample_rate"] == 500.0
    assert header["rig"] == "seat"
    assert {each.name for each in (tmp_path / "out").iterdir()} == {
        "recording.yaml", "map.yaml", "run-a.csv.gz", "manifest.json", "ro-crate-metadata.json",
    }  # fmt: skip


def test_import_prints_one_json_object(noisy_table, tmp_path, monkeypatch, capsys):
    path = write_csv(tmp_path / "a.csv", noisy_table)
    nominal = RECORDING / "nominal.yaml"
    words = ("import", path, "--out", tmp_path / "out", "--nominal", nominal, "--json")
    assert call(monkeypatch, *words) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["runs"] == ["run-a"]
    assert told["proposed"] is True
    assert told["channels"]["damper_force"]["unit"] == "N"
    assert set(told["doubts"][0]) == {"severity", "kind", "sentence", "channel", "run"}
    recording = {"run-a.csv.gz", "nominal.yaml", "map.yaml", "recording.yaml"}
    assert set(told["written"]) == {*recording, "manifest.json", "ro-crate-metadata.json"}


def test_bad_input_is_one_line_and_exit_2(tmp_path, monkeypatch, capsys):
    (tmp_path / "a.csv").write_text("")
    assert call(monkeypatch, "import", tmp_path / "a.csv", "--out", tmp_path / "out") == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert "a.csv: is empty" in said.err
    assert not (tmp_path / "out").exists()


def test_a_nominal_without_a_current_is_asked_for_one(noisy_table, tmp_path, monkeypatch, capsys):
    table = {name: noisy_table[name] for name in ("time", "floor_acceleration", "driver_acceleration")}
    path = write_csv(tmp_path / "a.csv", table)
    words = ("import", path, "--out", tmp_path / "out", "--nominal", RECORDING / "nominal.yaml")
    assert call(monkeypatch, *words) == 2
    assert "no current was recorded" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_inspect_shows_channels_and_doubts(noisy_table, tmp_path, monkeypatch, capsys):
    table = {**noisy_table, "driver_acceleration": noisy_table["driver_acceleration"] + 9.81}
    path = write_csv(tmp_path / "a.csv", {**table, "a_Sitz [g]": np.sin(np.arange(5001))})
    assert call(monkeypatch, "inspect", path) == 0
    said = capsys.readouterr()
    assert "suspension_displacement" in said.out
    assert "a_Sitz" in said.out
    assert "is gravity" in said.err
    assert call(monkeypatch, "inspect", path, "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert {each["name"] for each in told["channels"]} >= set(noisy_table) - {"time"}
    assert "gravity" in {each["kind"] for each in told["doubts"]}


def test_inspect_by_a_map_shows_what_import_would_make(noisy_table, tmp_path, monkeypatch, capsys):
    renamed = {"t": 1e3 * noisy_table["time"], "Kanal 1": -noisy_table["floor_acceleration"] / 9.80665}
    path, stated = write_csv(tmp_path / "a.csv", renamed), tmp_path / "map.yaml"
    stated.write_text(
        "time: {column: t, unit: ms}\nchannels: {floor_acceleration: {column: Kanal 1, unit: g, sign: -1}}\n"
    )
    assert call(monkeypatch, "inspect", path, "--map", stated, "--json") == 0
    (found,) = json.loads(capsys.readouterr().out)["channels"]
    assert (found["name"], found["unit"], found["rate"]) == ("floor_acceleration", "m/s^2", 500.0)
    assert found["rms"] == pytest.approx(np.sqrt(np.mean(noisy_table["floor_acceleration"] ** 2)), rel=1e-6)


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("floor_acceleration: {column: a, unit: kN}", "line 2, channels.floor_acceleration.unit: 'kN' is no unit"),
        ("floor_acceleration: {column: a, sgn: 1}", "did you mean 'sign'"),
        ("damper_force: {column: a}", "channel 'floor_acceleration' is missing"),
        ("floor_acceleration: {column: a}", ""),
    ],
)
def test_check_reads_a_map(tmp_path, monkeypatch, capsys, entry, said):
    stated = tmp_path / "map.yaml"
    stated.write_text(f"channels:\n  {entry}\n")
    assert call(monkeypatch, "check", stated) == (2 if said else 0)
    told = capsys.readouterr()
    assert said in told.err and ("map of a seat" in told.out) == (not said)


def test_names_of_others_are_shown_and_not_obeyed(noisy_table, tmp_path, monkeypatch, capsys):
    table = {"time": noisy_table["time"], ":smile: [/b] =1+1 [g]": noisy_table["floor_acceleration"]}
    path = write_csv(tmp_path / "a:smile:\x1b[31m[b].csv", table)
    assert call(monkeypatch, "inspect", path) == 0
    said = capsys.readouterr().out
    assert "a:smile:\\x1b[31m[b].csv" in said and ":smile: [/b] =1+1" in said and "\x1b" not in said
