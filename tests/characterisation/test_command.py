"""The command: files, tables, pictures of data and of models, refusals."""

import json
import math

import pandas as pd
import pytest
from typer.testing import CliRunner

from seatsim.characterisation.model_tests import characterise_model, choose_settings, load_specimen
from seatsim.cli.app import app
from seatsim.schema.errors import InputError

from ..identification.benches import columns
from ..text import words
from .conftest import DAMPER


def command(*arguments):
    return CliRunner().invoke(app, ["characterise", *map(str, arguments)])


def test_a_bench_table_gives_files_and_a_table(record, sine, tmp_path):
    motion, seconds = sine(0.01, 2.0)
    for name, current in (("low", 0.0), ("high", 1.0)):
        made = record(motion, seconds, lambda t, i=current: i + 0.0 * t)
        columns(made).to_csv(tmp_path / f"{name}.csv", index=False)
    done = command(tmp_path, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert "rebound [N]" in done.stdout.splitlines()[1]
    assert {path.name for path in (tmp_path / "out").iterdir()} == set(
        words("""
        cycles.csv characterisation.json characterisation.xlsx report.html loops.png energy.png
        manifest.json
    """)
    )
    found = pd.read_csv(tmp_path / "out" / "cycles.csv")
    assert list(found.current_A) == [1.0, 0.0] and list(found.cycles) == [8, 8]
    whole = json.loads((tmp_path / "out" / "characterisation.json").read_text())
    assert whole["records"][0]["energy_J"] == pytest.approx(found.energy_J[0])
    assert len(whole["records"][0]["cycle_values"]["energy"]) == 8 and whole["steps"] == []


def test_a_model_is_characterised_at_the_settings_given(tmp_path):
    done = command("--model", "bouc_wen", "--currents", "0,1", "--amplitudes", "0.005", "--frequencies",
                   "1,2", "--out", tmp_path / "out")  # fmt: skip
    assert done.exit_code == 0, done.output
    found = pd.read_csv(tmp_path / "out" / "cycles.csv")
    assert list(found.frequency_Hz.round(6)) == [1, 1, 2, 2] and list(found.current_A) == [0, 1, 0, 1]
    assert (tmp_path / "out" / "steps.png").exists()
    steps = json.loads((tmp_path / "out" / "characterisation.json").read_text())["steps"]
    assert [(step["before_A"], step["after_A"]) for step in steps] == [(0.0, 1.0), (1.0, 0.0)]
    assert all(step["current_t95_s"] == pytest.approx(math.log(20) / 130, rel=0.01) for step in steps)


def test_parameters_of_a_file_and_its_coil(tmp_path):
    path, stated = tmp_path / "damper.yaml", f"model: bouc_wen, parameters: {DAMPER._replace(f0=25.0)._asdict()}"
    path.write_text(f"damper: {{{stated}}}\nactuator: {{rate: 50, max_current: 0.8}}\n")
    tested = load_specimen(None, path)
    assert tested.damper.f0 == 25.0 and tested.coil.rate == 50
    found = characterise_model(tested, choose_settings(tested, "0,0.8", "", "0.005", "1"))
    assert [round(row.offset) for row in found.rows] == [25, 25]
    assert found.responses[0].current_t95 == pytest.approx(math.log(20.0) / 50.0, rel=0.01)
    path.write_text("model: original_bingham\nparameters: {f0: 25.0}\n")
    assert load_specimen("original_bingham", path).damper.f0 == 25.0


@pytest.mark.parametrize(
    "text, problem",
    [
        ("model: original_binghm", "did you mean 'original_bingham'"),
        ("damper: {model: original_bingham, parameters: {f1: 1.0}}", "unknown key"),
        ("model: original_bingham\nparam: {f0: 1.0}", "unknown key"),
        ("parameters: {f0: 1.0}", "'model' is missing"),
        ("model: bingham\nparameters: {c_a: 1.0}", "is missing"),
        ("model: ellis", "not the 'original_bingham' of --model"),
    ],
)
def test_bad_parameters_are_refused_at_their_place(text, problem, tmp_path):
    path = tmp_path / "damper.yaml"
    path.write_text(text + "\n")
    with pytest.raises(InputError, match=r"damper\.yaml, line \d") as error:
        load_specimen("original_bingham" if problem.startswith("not") else None, path)
    assert problem in str(error.value)


@pytest.mark.parametrize(
    "arguments, problem",
    [
        ([], "either DATA"),
        (["somewhere", "--model", "bingham"], "either DATA"),
        (["somewhere", "--currents", "0,1"], "either DATA"),
        (["--model", "bignham"], "did you mean 'bingham'"),
        (["--model", "bingham", "--currents", "0,-1"], "--currents 0,-1: '-1' is not permitted"),
        (["--model", "bingham", "--amplitudes", "5 mm"], "numbers above 0 m"),
        (["--model", "bingham", "--temperatures", "20,900"], "at most 200 degC"),
    ],
)
def test_bad_input_is_refused(arguments, problem, tmp_path, here):
    done = command(*arguments)
    assert isinstance(done.exception, InputError) and problem in str(done.exception)
    assert not list(tmp_path.iterdir())


def test_default_settings_keep_to_the_ranges_of_the_model():
    for name in ("yu2019", "modified_bouc_wen", "kwok_tanh"):
        tested = load_specimen(name, None)
        chosen = choose_settings(tested)
        speed = 2.0 * math.pi * max(chosen.amplitudes) * max(chosen.frequencies)
        assert speed <= tested.specification.max_speed and max(chosen.currents) == tested.specification.max_current
    assert choose_settings(load_specimen("yu2019", None)).temperatures == [20.0, 50.0, 80.0]
    assert choose_settings(load_specimen("yu2019", None), frequencies="0.7").amplitudes == [0.0035, 0.007]
