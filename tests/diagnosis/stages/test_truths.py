"""Diagnosis by truth: what is hidden in a linear seat, and what the whole way from recording to answer says of it."""

import dataclasses
import itertools
import json
from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

from seatsim.cli.outputs.diagnosis_results import write_diagnosis
from seatsim.diagnosis.diagnose import diagnose, diagnose_problem
from seatsim.diagnosis.result import Estimate, Share
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.diagnosis.solve import solve
from seatsim.effects.damper import GasSpring
from seatsim.effects.seat import Friction, Mass, ProgressiveSpring
from seatsim.effects.sensor import Gain
from seatsim.recordings.gap import measure_gap
from seatsim.report.formatting import format_sentence
from seatsim.scenario.loading import single
from seatsim.schema.errors import InputError
from seatsim.schema.registry import names

from .toy import CHANNELS, NOMINAL, SKIP, Added, pose, push, record, slow_floor

RUNS = {"first": 300, "second": 360, "third": 240}
MIDDLE, LONG = dict.fromkeys(RUNS, 400), dict.fromkeys(RUNS, 800)
SLOW = {run: slow_floor(SKIP + 300, seed) for seed, run in enumerate(RUNS, 3)}


def on_frame(problem, error):
    """Return an error of the frame's accelerometer in each run, by its number of rows."""
    return {run: {"frame_acceleration": error(values.shape[1])} for run, values in problem.measured.items()}


def drift(problem):
    """A zero of the frame's accelerometer that wanders."""
    return on_frame(problem, lambda rows: 0.3 * np.sin(2.0 * np.pi * 0.25 / problem.rate * np.arange(rows)))


def hiss(problem):
    """White noise on the frame's accelerometer, far above what its sensor states."""
    rng = np.random.default_rng(9)
    return on_frame(problem, lambda rows: 0.5 * rng.standard_normal(rows))


def pushed(newtons, port):
    """A random force at a port, another one in each run."""
    return lambda problem: push(problem, newtons, port)


class Row(NamedTuple):
    """What is hidden in a recording, and what a diagnosis must say: verdict, effects with sizes, first block."""

    truth: tuple
    verdict: str
    sizes: dict = {}  # noqa: RUF012
    block: str = ""
    disturb: object = None
    stochastic: str = ""
    group: tuple = ()
    runs: dict = RUNS
    channels: tuple = CHANNELS[:4]
    noise: float = 0.02
    nuisances: int = 1
    without: tuple = ()
    noted: str = ""
    highest: float = 100.0


RUB = {"suspension.friction": ("force", 60.0)}
HEAVY = {"driver.mass": ("change", 30.0)}
SPRINGS = ("damper.gas_spring", "suspension.progressive_spring")
FEW = {"runs": SLOW, "channels": CHANNELS[:2], "noise": 0.05, "group": SPRINGS}
TRUTHS = {
    "nothing": Row((), "none"),
    "nothing of a mass within its tolerance": Row((Mass(4.0),), "none", nuisances=2),
    "a heavier driver": Row((Mass(30.0),), "known", HEAVY, "driver"),
    "a heavier driver in one run": Row((Mass(30.0),), "known", HEAVY, "driver", runs={"only": 300}),
    "a wrong scale": Row((Gain("driver_acceleration", 0.2),), "known", {"sensor.gain": ("error", 0.2)}, "sensor"),
    "two effects": Row((Mass(30.0), Gain("frame_acceleration", 0.3)), "known",
                       HEAVY | {"sensor.gain": ("error", 0.3)}, "driver"),
    "friction in the linkage": Row((Friction(60.0),), "known", RUB, "suspension"),
    "a spring that a slow floor shows as another": Row(
        (ProgressiveSpring(800.0),), "ambiguous", {"suspension.progressive_spring": ("rise", 800.0)}, "suspension",
        **FEW),
    "the first spring on a rough floor": Row(
        (GasSpring(0.0, 800.0),), "known", {"damper.gas_spring": ("stiffness", 800.0)}, "damper",
        channels=CHANNELS[:2], noise=0.05),
    "a force from outside beside a driver": Row(
        (Mass(30.0),), "known", HEAVY, "floor", pushed(20.0, "suspension"), "floor.unmeasured_input", runs=LONG),
    "a force in the cushion beside a driver": Row(
        (Mass(30.0),), "unknown", HEAVY, "cushion", pushed(20.0, "cushion"), runs=MIDDLE),
    "a force in the damper": Row((), "unknown", {}, "damper", pushed(40.0, "damper"), runs=MIDDLE),
    "a drift": Row((), "known", {}, "sensor", drift, "sensor.bias", runs=LONG),
    "a broadband error beside a driver": Row((Mass(30.0),), "known", HEAVY, "driver", hiss, highest=50.0),
    "a driver outside its tolerance": Row((Mass(20.0),), "unknown", {}, "sensor", nuisances=2, without=("driver.mass",),
                                          noted="at the bound of their tolerance: plant.driver_mass 80 (fitted 88)"),
}  # fmt: skip


def record_row(folder, row, repeats=None):
    """Return the recording of a row, its disturbance added to what the toy seat answers."""
    recording = record(folder, row.truth, row.runs, row.channels, row.noise, repeats)
    if row.disturb:
        for run, added in row.disturb(pose(recording, row.nuisances)).items():
            for name, values in added.items():
                recording.tables[run][name][SKIP : SKIP + len(values)] += values
    return recording


@pytest.fixture(scope="module")
def solved(folder):
    """Return a function from the name of a row to its row, its problem, its diagnosis and what was said on the way."""

    @cache
    def solve(name):
        row, said = TRUTHS[name], []
        problem = pose(record_row(folder, row), row.nuisances, noise={"highest_frequency": row.highest})
        return row, problem, diagnose_problem(problem, ["a note"], row.without, said.append), said

    return solve


every = pytest.mark.parametrize("name", TRUTHS)


@every
def test_what_is_hidden_is_found_with_its_size_and_its_block(solved, name):
    row, _, found, _ = solved(name)
    assert (found.verdict, found.stochastic) == (row.verdict, row.stochastic)
    assert set(found.selected) == {*row.sizes, *([row.stochastic] if row.stochastic else [])}
    assert (found.where[0].block if found.where else "") == row.block
    assert [set(group) for group in found.indistinguishable] == ([set(row.group)] if row.group else [])
    causes = {cause.effect: cause for cause in found.causes}
    for effect, (field, true) in row.sizes.items():
        # A mass is taken in part by its own tolerance, of 8 kg, as its prior has it.
        assert causes[effect].parameters[field].value == pytest.approx(true, rel=0.03)
        # Beside an unknown cause an effect is stated that is likelier at work than not.
        assert causes[effect].probability > (0.45 if row.group else 0.55 if row.verdict == "unknown" else 0.8)
    assert any(row.noted in note for note in found.notes) and found.notes[0] == "a note"


@every
def test_the_gap_shrinks_within_its_interval_to_the_noise_where_all_is_explained(solved, name):
    row, problem, found, _ = solved(name)
    low, high = found.gap.shrink_interval
    assert low <= found.gap.shrink <= high <= 1.0
    if row.verdict != "unknown" and not row.stochastic and row.disturb is None:
        assert found.gap.after.overall == pytest.approx(found.gap.floor.overall, rel=0.1)
        explained = 1.0 - found.gap.floor.overall / found.gap.before.overall
        assert low - 0.02 <= explained <= high + 0.02
    if not found.selected and row.verdict == "unknown":
        assert found.gap.after == found.gap.before and found.gap.shrink == 0.0
    for amounts in (found.gap.before, found.gap.calibrated, found.gap.after):
        assert amounts.overall == pytest.approx(np.sqrt(np.mean(np.square(list(amounts.channels.values())))))
    nominal = measure_gap(problem.recording.nominal, problem.recording, found.held_out)
    assert found.gap.before.overall == pytest.approx(nominal.overall)


@every
def test_probabilities_shares_and_sentences_agree_with_the_verdict(solved, name):
    row, problem, found, said = solved(name)
    assert sum(share.share for share in found.where) == pytest.approx(1.0 if found.where else 0.0)
    assert all(a.share >= b.share for a, b in itertools.pairwise(found.where))
    assert {cause.effect for cause in found.causes} == set(names("effect")) - set(row.without)
    assert all(a.probability >= b.probability for a, b in itertools.pairwise(found.causes))
    likely = {"known": 0.5, "ambiguous": 0.5, "none": found.probability_none, "unknown": found.probability_unknown}
    assert likely[row.verdict] >= 0.5
    assert (found.probability_unknown > 0.5) == (row.verdict == "unknown")
    assert (found.probability_none > 0.5) == (row.verdict == "none")
    assert all(effect in found.sentence for effect in found.selected)
    assert said[0] == "weighing the channels" and said[-1] == "holding out a run"
    assert found.held_out[0] in problem.runs and (found.experiment is not None) == bool(row.group)


@every
def test_estimates_hold_the_truth_within_their_deviations(solved, name):
    row, _, found, _ = solved(name)
    for cause in found.causes:
        if cause.effect in row.sizes and row.verdict == "known" and not row.stochastic:
            field, true = row.sizes[cause.effect]
            estimate = cause.parameters[field]
            assert isinstance(estimate, Estimate) and 0.0 < estimate.std < 0.2 * abs(true)
            assert abs(estimate.value - true) < 4.0 * estimate.std


@pytest.mark.parametrize("name", ["two effects", "a spring that a slow floor shows as another"])
def test_neither_the_order_of_the_channels_nor_that_of_the_runs_changes_the_answer(solved, name):
    row, problem, found, _ = solved(name)
    back, turned = slice(None, None, -1), problem.recording
    runs = dict(list(turned.runs.items())[:2][back] + list(turned.runs.items())[2:])
    channels = problem.channels[back]
    recording = dataclasses.replace(turned, runs=runs)
    measured = {run: problem.measured[run][back] for run in runs}
    other = dataclasses.replace(problem, channels=channels, recording=recording, runs=tuple(runs), measured=measured)
    again = diagnose_problem(other, without=row.without)
    for stated in ("verdict", "selected", "indistinguishable"):
        assert getattr(again, stated) == getattr(found, stated)
    for effect, (field, _) in row.sizes.items():
        values = [next(c for c in each.causes if c.effect == effect).parameters[field].value for each in (found, again)]
        assert values[1] == pytest.approx(values[0], rel=1e-3)


def test_the_files_of_a_diagnosis_hold_the_gap_that_is_stated_and_the_pictures_show(solved, tmp_path):
    _, problem, found, _ = solved("two effects")
    write_diagnosis(found, tmp_path)
    written = json.loads((tmp_path / "diagnosis.json").read_text())
    assert {cause["effect"] for cause in written["causes"]} == set(names("effect"))
    assert sum(place["share"] for place in written["where"]) == pytest.approx(1.0)
    assert format_sentence(found.sentence) in (tmp_path / "report.html").read_text()
    left = measure_gap(single(tmp_path / "augmented.yaml"), problem.recording, written["held_out"])
    assert left.overall == pytest.approx(found.gap.after.overall, rel=1e-6)
    for k, trace in enumerate(found.evidence.traces):
        assert (trace.run, trace.channel) == (found.held_out[0], problem.channels[k])
        assert np.array_equal(trace.measured, problem.measured[trace.run][k])
        for values, gap in ((trace.nominal, found.gap.before), (trace.after, found.gap.after)):
            rms = np.sqrt(np.mean((trace.measured - values) ** 2)) / np.std(trace.measured)
            assert rms == pytest.approx(gap.channels[trace.channel], rel=1e-6)
    assert set(found.evidence.collinearity.effects) >= {"driver.mass", "sensor.gain"}


SETTINGS = DiagnosisSettings()
SETTINGS = SETTINGS._replace(damper_forms=SETTINGS.damper_forms._replace(least_rest=float("inf")))


def write(recording, folder, tolerance=0.1, runs=None):
    """Write a recording in memory as files, or some of its runs."""
    for run in runs or recording.runs:
        rows = recording.tables[run]
        table = {"time": np.arange(len(rows["floor_acceleration"])) / recording.header.sample_rate} | rows
        pd.DataFrame(table).to_csv(folder / f"{run}.csv", index=False)
    stated = recording.channels.items()
    channels = {name: {"unit": entry.unit, "noise_rms": float(entry.noise_rms)} for name, entry in stated}
    header = {"rig": "seat", "sample_rate": 200.0, "nominal": "nominal.yaml", "channels": channels}
    header |= {"runs": [{"name": run, "file": f"{run}.csv"} for run in runs or recording.runs]}
    header |= {} if tolerance is None else {"parameter_tolerance": tolerance}
    (folder / "nominal.yaml").write_text(NOMINAL)
    YAML(typ="safe").dump(header, folder / "recording.yaml")
    return folder


@pytest.fixture(scope="module")
def heavier(folder):
    return record(folder, (Mass(30.0),), LONG, CHANNELS[:4], 0.02)


def test_a_folder_is_examined_posed_and_diagnosed(heavier, tmp_path):
    said = []
    found = diagnose(write(heavier, tmp_path, None), progress=said.append, settings=SETTINGS, budget=1200.0)
    assert "driver.mass" in found.selected and said[0] == "looking at the data"
    assert any(note.startswith("parameter_tolerance is not stated") for note in found.notes)


def test_a_second_recording_is_joined_to_the_first(heavier, tmp_path):
    folders = [tmp_path / name for name in ("first", "second")]
    for folder, runs in zip(folders, (["first"], ["second", "third"]), strict=True):
        folder.mkdir()
        write(heavier, folder, runs=runs)
    found = diagnose(folders[0], after=folders[1], settings=SETTINGS, budget=1200.0)
    assert "driver.mass" in found.selected and len(found.gap.by_run) == 3


@pytest.mark.parametrize("repeats", [None, {"again": "first"}])
def test_a_material_force_is_named_and_no_noise_by_which_repeats_differ(folder, repeats):
    floor = np.random.default_rng(4).standard_normal(SKIP + 400)
    runs, row = {"first": floor, "again": floor}, Row((Mass(30.0),), "known", disturb=pushed(20.0, "suspension"))
    found = solve(pose(record_row(folder, row._replace(runs=runs), repeats), 1), (), lambda _: None)
    assert (found.decision.verdict, found.decision.chosen.parameters.names) == ("known", {"driver.mass"})
    assert found.stochastic == "floor.unmeasured_input"


def test_on_a_bench_what_is_unexplained_lies_in_the_damper(folder):
    problem = pose(record(folder, (Added("three", 1.0),), MIDDLE, CHANNELS[:4], 0.02))
    bench = dataclasses.replace(problem.recording, header=problem.recording.header._replace(rig="damper_bench"))
    found = solve(dataclasses.replace(problem, recording=bench), (), lambda _: None)
    assert found.decision.verdict == "unknown" and found.where == [Share("damper", 1.0)] and found.discrepancy is None


@pytest.mark.parametrize("budget", [1e-6, 1e-3])
def test_however_short_the_time_there_is_an_answer_that_says_what_was_cut(solved, budget):
    found = diagnose_problem(solved("a heavier driver")[1], budget=budget)
    assert any(note.startswith(f"the budget of {budget:g} s was spent") for note in found.notes)
    assert found.verdict in ("known", "ambiguous", "unknown") and found.augmented["plant"]
    assert budget > 1e-6 or (found.verdict, found.selected) == ("unknown", [])


@pytest.mark.parametrize("budget", [0.0, -1.0, float("nan")])
def test_a_budget_that_is_none_is_refused(budget):
    with pytest.raises(InputError, match=r"a budget of .* is not permitted; it must be above 0"):
        diagnose("somewhere", budget=budget)


HEADER = """\
rig: seat
sample_rate: 200.0
nominal: nominal.yaml
runs: [{name: first, file: first.csv}]
channels: {floor_acceleration: {unit: m/s^2, noise_rms: 0.01}, driver_acceleration: {unit: m/s^2, noise_rms: 0.01}}
"""


def test_a_dead_sensor_is_refused_before_anything_is_fitted(tmp_path):
    floor = np.random.default_rng(1).standard_normal(SKIP + 2200)
    (tmp_path / "nominal.yaml").write_text(NOMINAL)
    (tmp_path / "recording.yaml").write_text(HEADER)
    rows = [f"{k / 200.0},{value},0.0" for k, value in enumerate(floor)]
    (tmp_path / "first.csv").write_text("\n".join(["time,floor_acceleration,driver_acceleration", *rows]))
    with pytest.raises(InputError, match=r"first, driver_acceleration: is 0 throughout; the sensor is dead"):
        diagnose(tmp_path)
