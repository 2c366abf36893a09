"""The command: files, tables and pictures of data, dampers of files."""

import json

import pytest
from typer.testing import CliRunner

from seatsim.characterisation.summary import load_damper
from seatsim.cli.app import app
from seatsim.schema.errors import InputError

from ..identification.benches import columns
from ..text import words


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
        characterisation.json characterisation.xlsx report.html loops.png energy.png
        manifest.json
    """)
    )
    whole = json.loads((tmp_path / "out" / "characterisation.json").read_text())
    assert [(row["current_A"], row["cycles"]) for row in whole["records"]] == [(1.0, 8), (0.0, 8)]
    assert len(whole["records"][0]["cycle_values"]["energy"]) == 8 and whole["response"] == []


@pytest.mark.parametrize(
    "text, problem",
    [
        ("model: original_binghm", "did you mean 'original_bingham'"),
        ("damper: {model: original_bingham, parameters: {f1: 1.0}}", "unknown key"),
        ("model: original_bingham\nparam: {f0: 1.0}", "unknown key"),
        ("parameters: {f0: 1.0}", "'model' is missing"),
        ("model: bingham\nparameters: {c_a: 1.0}", "is missing"),
    ],
)
def test_bad_parameters_are_refused_at_their_place(text, problem, tmp_path):
    path = tmp_path / "damper.yaml"
    path.write_text(text + "\n")
    with pytest.raises(InputError, match=r"damper\.yaml, line \d") as error:
        load_damper(path)
    assert problem in str(error.value)
