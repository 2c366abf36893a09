"""`--json`: one object on standard output and nothing else there, of the form that is documented."""

import json
import math
from pathlib import Path

import pytest
from typer.main import get_command

from seatsim.blind.score.score import ShrinkScore, score_verdicts
from seatsim.blind.score.verdicts import Rate, Verdict
from seatsim.cli.app import app
from seatsim.cli.outputs.answers import list_answers
from seatsim.recordings.gap import Forecast, GapFigures, MeasuredShrink
from seatsim.recordings.prediction import Expected, Prediction
from seatsim.schema.content import to_content

from ..answers import check_answer
from ..report.diagnoses import CASES

ROOT = Path(__file__).resolve().parents[2]
RECORDING = ROOT / "scenarios" / "data" / "recording"
BENCH = ROOT / "scenarios" / "data" / "bench"
SHORT = ("--set", "excitation.duration=2")
COMMANDS = {"run": ("run", *SHORT), "compare": ("compare", "--set", "variants={a: {}, b: {seed: 2}}", *SHORT)}
COMMANDS |= {"check": ("check", RECORDING), "inspect": ("inspect", RECORDING), "comfort": ("comfort", RECORDING)}
COMMANDS |= {"describe": ("describe", "road"), "synthesise": ("synthesise", "h-infinity"), "new": ("new", "damper")}
COMMANDS |= {"characterise": ("characterise", BENCH), "gap": ("gap", RECORDING / "nominal.yaml", RECORDING)}
COMMANDS |= {
    "import": ("import", RECORDING / "run-1.csv.gz", "--nominal", RECORDING / "nominal.yaml"),
    "export": ("export", "quickstart", "--to", "c", "--what", "damper"),
    "identify": ("identify", BENCH / "sine_4mm_4Hz.csv", "--model", "bingham", "--fix", "v_ref=0.01"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_standard_output_is_one_object(name, seatsim_command, undrawn, kept_seat_file, tmp_path):
    own = {"describe": [], "check": [], "inspect": [], "new": [tmp_path / "my_own"]}
    place = own.get(name, ["--out", tmp_path])
    place = ["--out", tmp_path / "damper.c"] if name == "export" else place
    seat = [kept_seat_file] if name in ("run", "compare") else []
    status, out, _ = seatsim_command(*COMMANDS[name], *seat, *place, "--json")
    assert status == 0
    found = check_answer(name, out)
    assert all(Path(file).is_file() for file in found["files"])
    assert bool(found["files"]) == bool(place)


@pytest.mark.parametrize("case", CASES)
def test_a_diagnosis_is_of_the_documented_form(case):
    check_answer("diagnose", json.dumps({**to_content(CASES[case]()), "files": []}))


@pytest.mark.parametrize("measured", [None, MeasuredShrink(0.4, 0.1, 0.75, {"damper_force": 0.4})])
def test_a_forecast_is_of_the_documented_form(measured):
    predicted = Prediction(0.4, 0.1, 0.75, (0.7, 0.8), {"damper_force": Expected(0.4, 0.1)})
    found = Forecast(math.nan, {}, GapFigures(math.nan, {}), ("a note",), measured, predicted=predicted)
    content = check_answer("gap", json.dumps({**to_content(found), "files": []}))
    assert ("measured" in content) == (measured is not None) and content["overall"] is None


def test_a_score_is_of_the_documented_form():
    wrong = Verdict("known", ("sensor",), ("sensor.gain",), {"sensor.gain": 0.9})
    once = ShrinkScore(0.1, 0.0, Rate(1, 1), [("a", 0.5, 0.6, True)])
    label = {"kind": "none", "effects": [], "blocks": []}
    found = score_verdicts({"a": label}, {"a": wrong}, once._replace(predicted=once))
    check_answer("blind-score", json.dumps({**to_content(found), "files": []}))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("gapp",), "No such command 'gapp'"),
        (("gap", "--jsn"), "No such option: --jsn"),
        (("gap",), "Missing argument"),
        (("blind", "make"), "Missing option"),
        (("comfort", "x", "--hours", "a"), "hours"),
        (("run", "quickstrat"), "did you mean 'quickstart'"),
    ],
)
def test_a_wrong_use_of_the_command_line_is_an_object_too(seatsim_command, arguments, said):
    status, out, err = seatsim_command(*arguments, "--json")
    assert status == 2 and said in check_answer("error", out)["error"] and said in err
    # The next command has no such option.
    assert seatsim_command(*arguments)[1] == ""


def test_every_command_has_it_and_a_documented_form():
    commands = get_command(app).commands
    blind = {f"blind-{name}": command for name, command in commands.pop("blind").commands.items()}
    for name, command in {**commands, **blind}.items():
        assert any("--json" in option.opts for option in command.params), name
        assert name == "schema" or name in list_answers(), name
