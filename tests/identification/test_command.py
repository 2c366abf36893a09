"""The command: files, tables and pictures, the league, what is refused and what fails."""

import json
import math

import pandas as pd
import pytest
from ruamel.yaml import YAML
from typer.testing import CliRunner

from seatsim.characterisation.summary import load_damper
from seatsim.cli.app import app
from seatsim.cli.outputs.damper_results import write_identification
from seatsim.identification import identify as module
from seatsim.identification.identify import benchmark_models, identify
from seatsim.identification.search import ignore_progress
from seatsim.identification.settings import IdentificationSettings as Settings
from seatsim.scenario.loading import single
from seatsim.schema.errors import InputError

from ..text import beside
from .benches import BINGHAM, made, sines

FILES = {"parameters.yaml", "fit.json", "report.html", "loops.png"}
DOCUMENTED = {*FILES, "manifest.json"}
SCENARIO = beside(__file__, "seat_without_damper.yaml")


def command(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="session")
def fitted(bench, tmp_path_factory):
    """A folder with what the command writes, and what it prints."""
    folder = tmp_path_factory.mktemp("fitted")
    options = ("--model", "bingham", "--test", "*2.5Hz*")
    done = command("identify", bench, *options, "--out", folder)
    assert done.exit_code == 0, done.output
    return folder, done.output


def test_files_and_tables_are_written(fitted):
    folder, said = fitted
    assert {path.name for path in folder.iterdir()} == DOCUMENTED
    assert (folder / "loops.png").stat().st_size > 10000
    for text in ("sine_2.5Hz, 1 A", "mean, held out", "c_b", "N·s/(m·A)", f"written to {folder}:"):
        assert text in said.replace("\n", "") or text in said, text


def test_fit_json_holds_the_figures_of_every_record_and_their_means(fitted):
    fit = json.loads((fitted[0] / "fit.json").read_text())
    for part in ("train", "test"):
        assert set(fit[part]) == {"r2", "md", "rmse", "fit_percent"} and fit[part]["fit_percent"] > 97.0
    assert sorted(fit["records"]) == sorted(["sine_2Hz, 0 A", "sine_4Hz, 0.5 A", "sine_2.5Hz, 1 A"])
    train = [record for record in fit["records"].values() if record["part"] == "train"]
    assert fit["train"]["rmse"] == pytest.approx(sum(record["rmse"] for record in train) / 2.0)
    assert fit["records"]["sine_2.5Hz, 1 A"]["current"] == 1.0
    assert {estimate["name"] for estimate in fit["parameters"]} == {"c_a", "c_b", "fc_a", "fc_b", "f0"}
    assert fit["not_identified"] == []
    assert fit["ns_per_step"] > 0.0 and fit["effective_samples"] > 100.0 and "commands" not in fit


def test_the_parameters_are_pasted_into_a_scenario_and_characterised(fitted, bench, tmp_path):
    path = fitted[0] / "parameters.yaml"
    values = YAML(typ="safe").load(path.read_text())
    assert list(values) == ["damper", "actuator", "bench"]
    assert values["damper"]["parameters"]["c_a"] == pytest.approx(BINGHAM.c_a, rel=0.05)
    assert values["actuator"] == {"rate": 130.0, "rate_fall": 130.0, "max_current": 1.0}
    assert "the rates of the actuator are defaults" in path.read_text()
    pasted = path.read_text().partition("bench:\n")[0]
    (tmp_path / "seat.yaml").write_text(SCENARIO + pasted)
    pasted_damper = single(tmp_path / "seat.yaml").damper.record._asdict()
    assert pasted_damper.items() >= values["damper"]["parameters"].items()
    done = command("characterise", bench, "--beside", path, "--out", tmp_path / "shown")
    assert done.exit_code == 0, done.output
    shown = json.loads((tmp_path / "shown" / "characterisation.json").read_text())
    pairs = zip(shown["peak_forces"], shown["beside"], strict=True)
    assert all(model["rebound"] == pytest.approx(measured["rebound"], rel=0.1) for measured, model in pairs)


def test_factors_of_temperature_and_laws_are_written_and_read_again(tmp_path):
    records = [made(current=i, temperature=warm, name=f"{warm:g}C_{i:g}A") for warm in (20.0, 60.0) for i in (0.0, 1.0)]
    folder = tmp_path / "warm"
    folder.mkdir()
    for record in records:
        table = {"time_s": record.time, "x_m": record.displacement, "force_N": record.force}
        table |= {"current_A": record.mean_current, "temperature_C": record.temperature[0]}
        pd.DataFrame(table).to_csv(folder / record.file, index=False)
    found = identify(folder, "original_bingham")
    write_identification(found, tmp_path / "out", 0)
    values = YAML(typ="safe").load((tmp_path / "out" / "parameters.yaml").read_text())
    assert values["damper"]["temperature_factors"]["reference"] == pytest.approx(40.0)
    assert len(values["damper"]["parameters"]["c0"]) == 4
    assert load_damper(tmp_path / "out" / "parameters.yaml").factors == found.bench.factors


# --------------------------------------------------------------------------------------------------- the league


@pytest.fixture
def two(monkeypatch):
    """Two small models in place of all."""
    monkeypatch.setattr(module, "names", lambda kind: ["original_bingham", "bingham"])


def test_the_league_ranks_models_by_what_was_held_out(two, bench, tmp_path):
    options = ("--model", "all", "--test", "*2.5Hz*", "--fix", "v_ref=0.004")
    done = command("identify", bench, *options, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    table = pd.read_csv(tmp_path / "out" / "league.csv")
    assert list(table.columns[:5]) == ["model", "train_fit_percent", "test_fit_percent", "parameters", "ns_per_step"]
    assert list(table.model) == ["bingham", "original_bingham"] and list(table.parameters) == [5, 5]
    assert table.test_fit_percent.is_monotonic_decreasing and table.failed.isna().all()
    for model in table.model:
        assert {path.name for path in (tmp_path / "out" / model).iterdir()} == FILES
    fit = json.loads((tmp_path / "out" / "bingham" / "fit.json").read_text())
    assert fit["test"]["fit_percent"] == pytest.approx(table.test_fit_percent[0])


def test_a_league_goes_on_past_a_model_that_fails(tmp_path):
    records = [record._replace(force=record.force + 4000.0) for record in sines(BINGHAM)]
    kept, models = [], ["hong_sigmoid_gaussian", "bingham"]
    found = benchmark_models(records, models, Settings(), ignore_progress, kept.append)
    assert [place.model for place in found] == ["bingham", "hong_sigmoid_gaussian"]
    assert "mean alone fits better; choose another model" in found[1].failed and math.isnan(found[1].train_fit_percent)
    assert [each.model for each in kept] == ["bingham"]


# ------------------------------------------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    "options, problem",
    [
        (["--model", "bignham"], "did you mean 'bingham'"),
        (["--model", "bingham", "--test", "*9Hz*"], "--test *9Hz* matches no record"),
        (["--model", "bingham", "--fix", "c_a=much"], "--fix c_a=much is not permitted; it must be a number"),
        (["--model", "bingham", "--fix", "c_a"], "--fix c_a: write KEY=VALUE, such as --fix v_ref=0.005"),
        (["--model", "all", "--test", "*9Hz*"], "--test *9Hz* matches no record"),
        (["--model", "all", "--fix", "c_qq=1"], "--fix c_qq: no model has this number"),
    ],
)
def test_bad_input_is_refused_and_nothing_written(options, problem, bench, tmp_path, here):
    done = command("identify", bench, *options)
    assert isinstance(done.exception, InputError) and problem in str(done.exception)
    assert not list(tmp_path.iterdir())
