"""new, check and schema: files that work as they are written, and what is said of those that do not."""

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import seatsim
from seatsim.cli.new_files import KINDS, REGISTERED, write_new
from seatsim.cli.outputs.answers import FILES
from seatsim.diagnosis.result import Cause, Estimate
from seatsim.report.diagnosis import tabulate_diagnosis
from seatsim.schema.registry import find

from ..report.diagnoses import CASES

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = [path for path in sorted((ROOT / "scenarios").rglob("*.yaml")) if path.parent.name != "bench"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_file_works_as_it_stands(kind, tmp_path, seatsim_command, forget_own_code):
    status, out, _ = seatsim_command("new", kind, tmp_path / "first_try")
    assert status == 0 and "next: " in out
    (file,) = [path for path in tmp_path.iterdir() if path.stem == "first_try"]
    status, out, err = seatsim_command("check", file)
    assert status == 0 and "no errors" in out and not err
    if kind in REGISTERED:
        assert f"{REGISTERED[kind]} " in out and "first_try" in out


@pytest.mark.slow
def test_new_classes_run_in_a_scenario(tmp_path, seat_file, forget_own_code):
    for kind in REGISTERED:
        (path,) = write_new(kind, tmp_path / f"own_{kind}")
        seatsim.use(path)
    own = {"damper": {"model": "own_damper"}, "controller": {"law": "own_controller"}}
    own |= {"excitation": {"kind": "own_excitation", "duration": 2.0}}
    own |= {"effects": [{"effect": "suspension.own_effect", "parameters": {"drag": 100.0}}]}
    result = seatsim.run(seat_file, own)
    assert result["driver_acceleration"].std() > 0.1
    assert find("damper", "own_damper").__name__ == "OwnDamper"


@pytest.mark.slow
def test_a_new_scenario_runs(tmp_path):
    path, _ = write_new("scenario", tmp_path / "mine.yaml")
    assert path == tmp_path / "mine.yaml"
    result = seatsim.run(path, {"excitation.duration": 2.0})
    assert [run.scenario.name for run in result.runs] == ["mine"] * 3
    assert not [sentence for run in result.runs for sentence in run.warnings]


@pytest.mark.parametrize(
    ("kind", "name", "problem"),
    [
        ("dampr", "x", "did you mean 'damper'"),
        ("damper", "a-b", "cannot be the name of a module"),
        ("damper", "bouc_wen", "there is a damper called 'bouc_wen' already"),
        ("effect", "friction", "there is a effect called 'friction' already"),
        ("scenario", "there", "is there already, and is not replaced"),
    ],
)
def test_what_cannot_be_new(kind, name, problem, tmp_path, seatsim_command):
    (tmp_path / "there.yaml").write_text("mine: 1\n")
    status, _, err = seatsim_command("new", kind, tmp_path / name)
    assert status == 2 and problem in err
    assert [path.name for path in tmp_path.iterdir()] == ["there.yaml"]
    assert (tmp_path / "there.yaml").read_text() == "mine: 1\n"


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("a.py", "1 / 0\n", "ZeroDivisionError"),
        ("recording.yaml", "rig: seat\n", "missing"),
        ("absent.yaml", None, "no such file"),
    ],
)
def test_check_says_what_is_wrong(name, text, problem, tmp_path, seatsim_command, forget_own_code):
    if text is not None:
        (tmp_path / name).write_text(text)
    status, _, err = seatsim_command("check", tmp_path / name)
    assert status == 2 and problem in err


def test_a_check_that_fails_is_named_with_its_figure(seat_file, seatsim_command):
    checks = "checks: {seat_factor: {max: 0.1}, driver_acceleration_rms: {max: 9.0}}\n"
    seat_file.write_text(seat_file.read_text() + checks)
    assert seatsim_command("check", seat_file)[0] == 0
    status, _, err = seatsim_command("check", seat_file, "--run")
    assert status == 1 and "FAILED: seat, seat_factor: seat_factor is " in err and err.count("FAILED") == 1
    status, out, _ = seatsim_command("check", seat_file, "--run", "--json")
    rows = [(row["check"], row["max"], row["pass"]) for row in json.loads(out)["checks"]]
    assert status == 1 and rows == [("seat_factor", 0.1, False), ("driver_acceleration_rms", 9.0, True)]
    seat_file.write_text(seat_file.read_text().replace("max: 0.1", "max: 9.0"))
    assert seatsim_command("check", seat_file, "--run")[0] == 0


def test_a_scenario_without_checks_is_an_error(seat_file, seatsim_command):
    code, _, err = seatsim_command("check", seat_file, "--run")
    assert code == 2
    assert "states nothing under 'checks'" in err


def test_the_schema_has_units_bounds_defaults_and_names(seatsim_command):
    assert "permitted: scenario" in seatsim_command("schema", "scenaro")[2]
    found = FILES["scenario"]()["properties"]
    mass = found["plant"]["properties"]["driver_mass"]
    assert mass["unit"] == "kg" and mass["exclusiveMinimum"] == 0 and mass["maximum"] == 1e4
    assert found["actuator"]["required"] == ["rate", "max_current"]
    assert "bouc_wen" in found["damper"]["properties"]["model"]["anyOf"][0]["enum"]
    road = next(case for case in found["excitation"]["allOf"] if case["if"]["properties"]["kind"]["const"] == "road")
    assert road["then"]["properties"]["vehicle"]["properties"]["axle_mass"]["unit"] == "kg"
    assert road["then"]["required"] == ["road_class", "speed", "duration"]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_every_example_names_its_schema_and_keeps_to_its_keys(path):
    text = path.read_text(encoding="utf-8")
    (line,) = [line for line in text.splitlines() if line.startswith("# yaml-language-server: $schema=")]
    schema = json.loads((path.parent / line.partition("=")[2]).read_text(encoding="utf-8"))
    content = YAML(typ="safe").load(text)
    assert set(schema["required"]) <= set(content) <= set(schema["properties"])


def test_own_classes_are_called_own_and_never_published(tmp_path, seatsim_command, forget_own_code):
    (damper,), (effect,) = write_new("damper", tmp_path / "mine"), write_new("effect", tmp_path / "yours")
    listed = seatsim_command("describe", "--with", damper, "--with", effect)[1].splitlines()
    assert [line.split()[0] for line in listed if "(own)" in line] == ["mine", "suspension.yours"]
    page = seatsim_command("describe", "mine", "--with", damper)[1]
    assert page.startswith("mine (damper, own)") and "Confidence: own" in page and "published" not in page
    (cause,) = [Cause("suspension.yours", 0.9, 0.8, {})]
    ended = cause._replace(parameters={"drag": Estimate(9.0, 1.0, "N", (0.0, 9.0), True)})
    tables = tabulate_diagnosis(replace(CASES["known"](), causes=[ended]))
    ranked = next(table for table in tables if "effect" in table.head)
    assert ranked.rows[0][0] == "suspension.yours (own)" and "(the end of its range)" in ranked.rows[0][2]


def test_a_league_of_chosen_models_with_one_of_your_own(tmp_path, seatsim_command, forget_own_code):
    (damper,) = write_new("damper", tmp_path / "mine")
    table = ROOT / "scenarios" / "data" / "bench" / "sine_4mm_4Hz.csv"
    models = ("--model", "bingham", "--model", "mine:Mine", "--with", damper)
    status, out, _ = seatsim_command("identify", table, *models, "--out", tmp_path / "league")
    assert status == 0 and re.search("mine:Mine +own", out)
    rows = csv.DictReader((tmp_path / "league" / "league.csv").read_text().splitlines())
    assert {row["model"]: row["confidence"] for row in rows} == {"bingham": "published", "mine:Mine": "own"}
    assert (tmp_path / "league" / "Mine" / "parameters.yaml").exists()


def test_a_picture_of_loops(tmp_path, seatsim_command):
    status, out, _ = seatsim_command("describe", "bingham", "--picture", tmp_path / "loops.png")
    assert status == 0 and out.startswith("bingham (damper)")
    assert (tmp_path / "loops.png").read_bytes().startswith(b"\x89PNG")
    for name, picture in (("road", "a.png"), ("bingham", "a.txt")):
        status, _, err = seatsim_command("describe", name, "--picture", tmp_path / picture)
        assert status == 2 and "one damper, as .png, .svg, .pdf" in err
