"""Other forms of the damper: the true one is found in the place of a wrong nominal, none beside a right one."""

import dataclasses

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

import seatsim
from seatsim.diagnosis.alternatives import are_forms_due, compare_damper_forms, describe_forms, describe_obstacle
from seatsim.diagnosis.result import DamperForm, GapFigures, Gaps
from seatsim.effects.base import EFFECTS
from seatsim.effects.damper import GasSpring
from seatsim.effects.sensor import Gain
from seatsim.excitations.recording import interpolate_floor
from seatsim.recordings.gap import measure_gap
from seatsim.recordings.recording import BENCH_CHANNELS, SEAT_CHANNELS
from seatsim.report.diagnosis import report_diagnosis, tabulate_diagnosis
from seatsim.report.rendering import render_report
from seatsim.scenario.loading import single
from seatsim.schema.content import to_content
from seatsim.simulation.inputs import BenchInputs, SeatInputs
from seatsim.simulation.respond import respond

from ..text import parse
from .posed import pose

RATE, SECONDS = 200.0, 5
TRUE = parse("""
    {c_a: 250.0, c_b: 350.0, alpha_a: 45.0, alpha_b: 620.0, k0: 0.0, x0: 0.0, f0: 0.0, A: 500.0, beta: 250.0,
     gamma: 250.0, n: 2}
""")
NOMINALS = {
    "bouc_wen": TRUE | {"c_a": 255.0, "alpha_b": 610.0},
    # The yield force of the true damper is alpha, since its z settles at 1.
    "bingham": {"c_a": 250.0, "c_b": 350.0, "fc_a": 45.0, "fc_b": 620.0, "f0": 0.0, "v_ref": 0.01},
}
PLANT = parse("""
    {frame_mass: 20.0, driver_mass: 80.0, suspension_stiffness: 4600.0, suspension_damping: 150.0,
     cushion_stiffness: 60000.0, cushion_damping: 1500.0}
""")
NOISE = {"displacement": 1e-6, "suspension_displacement": 1e-6, "damper_force": 2.0, "frame_acceleration": 0.01}
OTHERS = [name for name in EFFECTS.names() if name != "damper.gas_spring"]
"""Effects withheld where not they are tested: a diagnosis with one effect is quick."""
BENCH = {"actuator": {"rate": 130.0, "max_current": 1.0}, "temperature": 20.0}
SEAT = BENCH | {"plant": PLANT, "controller": {"law": "replay"}, "excitation": {"kind": "recording"}}


def narrow_band(rng, low, high, size):
    """Return a random signal of this RMS between two frequencies in Hz, shape (rows,)."""
    rows = round(RATE * (SECONDS + 1))
    frequency = np.fft.rfftfreq(rows, 1.0 / RATE)
    white = np.fft.rfft(rng.standard_normal(rows))
    signal = np.fft.irfft(np.where((frequency > low) & (frequency < high), white, 0.0), rows)
    signal *= np.minimum(1.0, np.arange(rows) / RATE)
    return size * signal / np.std(signal)


def drive(rig, rng):
    """Return the recorded inputs of a run."""
    rows = round(RATE * (SECONDS + 1))
    current = np.repeat(rng.uniform(0.1, 0.8, rows // 100 + 1), 100)[:rows]
    if rig == "seat":
        return {"floor_acceleration": narrow_band(rng, 0.7, 12.0, 2.0), "current_command": current}
    return {"displacement": narrow_band(rng, 0.5, 6.0, 0.006), "current_command": current}


def simulate(truth, table):
    if "displacement" in table:
        return respond(truth, BenchInputs(1.0 / RATE, table["displacement"], current_command=table["current_command"]))
    return respond(truth, SeatInputs(interpolate_floor(table, 5, 0.2 / RATE), 1.0 / RATE))


def record(folder, nominal="bingham", rig="damper_bench", effects=(), runs=3, outputs=("damper_force",)):
    """Write a recording of a rig with a Bouc-Wen damper beside a nominal scenario, and return its problem."""
    folder.mkdir(exist_ok=True)
    base, units = (SEAT, SEAT_CHANNELS) if rig == "seat" else (BENCH, BENCH_CHANNELS)
    damper = {"model": nominal, "parameters": NOMINALS[nominal]}
    YAML(typ="safe").dump(base | {"damper": damper}, folder / "nominal.yaml")
    YAML(typ="safe").dump(base | {"damper": {"model": "bouc_wen", "parameters": TRUE}}, folder / "true.yaml")
    truth, rng = dataclasses.replace(single(folder / "true.yaml"), effects=effects), np.random.default_rng(4)
    for k in range(runs):
        table = drive(rig, rng)
        true = simulate(truth, table)
        table |= {name: true[name] + NOISE[name] * rng.standard_normal(len(true[name])) for name in outputs}
        pd.DataFrame(table).to_csv(folder / f"run-{k}.csv", index=False)
    channels = {name: {"unit": units[name], "noise_rms": NOISE.get(name, 0.0)} for name in table}
    entries = [{"name": f"run-{k}", "file": f"run-{k}.csv"} for k in range(runs)]
    header = {"rig": rig, "sample_rate": RATE, "nominal": "nominal.yaml", "runs": entries, "channels": channels}
    YAML(typ="safe").dump(header, folder / "recording.yaml")
    return pose(folder)


def try_only(problem, *models):
    forms = problem.settings.damper_forms._replace(models=models)
    return dataclasses.replace(problem, settings=problem.settings._replace(damper_forms=forms))


@pytest.fixture(scope="module")
def wrong_form(tmp_path_factory):
    return record(tmp_path_factory.mktemp("wrong") / "rig")


def test_the_true_form_is_named_first_in_the_place_of_a_wrong_one(wrong_form):
    nominal = wrong_form.recording.nominal
    found = compare_damper_forms(try_only(wrong_form, "biviscous", "bouc_wen"), nominal, nominal, "run-2")
    assert [form.model for form in found] == ["bouc_wen", "biviscous"]
    best = found[0]
    assert best.replaces == "bingham" and best.beside == () and best.shrink > 0.8 > 0.3 > best.refitted
    assert best.parameters["c_b"] == pytest.approx(TRUE["c_b"], rel=0.1)
    ratio = best.parameters["alpha_b"] / best.parameters["alpha_a"]
    assert ratio == pytest.approx(TRUE["alpha_b"] / TRUE["alpha_a"], rel=0.3)


def test_no_form_helps_a_right_one(tmp_path):
    problem = record(tmp_path / "rig", nominal="bouc_wen")
    right = single(tmp_path / "rig" / "true.yaml")
    found = compare_damper_forms(try_only(problem, "biviscous", "bouc_wen"), right, right, "run-2")
    assert [form.model for form in found if form.model == "bouc_wen"] == []
    assert found and all(form.shrink < 0.1 and form.refitted < 0.1 for form in found)


def test_a_form_is_fitted_beside_the_effects_found_and_instead_of_them(tmp_path):
    effects = GasSpring(preload=80.0), Gain("damper_force", 0.2)
    problem = record(tmp_path / "rig", effects=effects)
    nominal = problem.recording.nominal
    augmented = dataclasses.replace(nominal, effects=effects)
    found = compare_damper_forms(try_only(problem, "bouc_wen"), nominal, augmented, "run-2")
    instead, beside = sorted(found, key=lambda form: form.beside)
    assert beside.beside == ("damper.gas_spring", "sensor.gain") and instead.beside == ()
    # Without them the offset and the gain go into the free parameters of the form.
    assert abs(beside.parameters["f0"]) < 5.0 < 90.0 < instead.parameters["f0"]
    assert beside.parameters["c_b"] == pytest.approx(TRUE["c_b"], rel=0.1)
    assert instead.parameters["c_b"] == pytest.approx(1.2 * TRUE["c_b"], rel=0.1)


def test_a_seat_is_simulated_with_the_form_that_fits_its_damper_force_best(tmp_path):
    outputs = "damper_force", "suspension_displacement", "frame_acceleration"
    problem = record(tmp_path / "rig", rig="seat", outputs=outputs)
    nominal, true = problem.recording.nominal, single(tmp_path / "rig" / "true.yaml")
    (form,) = compare_damper_forms(try_only(problem, "biviscous", "bouc_wen"), nominal, nominal, "run-2")
    before, best = (measure_gap(rig, problem.recording, ["run-2"]).overall for rig in (nominal, true))
    assert form.model == "bouc_wen"
    assert 0.6 < form.shrink < 1.0 - best / before + 0.01


def test_why_no_form_can_be_judged_is_said(wrong_form, tmp_path):
    assert describe_obstacle(wrong_form) == ""
    assert "no second run" in describe_obstacle(wrong_form.on_runs(["run-1"]))
    blind = record(tmp_path / "rig", rig="seat", outputs=("damper_force", "frame_acceleration"))
    assert "suspension_displacement is not recorded" in describe_obstacle(blind)


def gaps(calibrated, after, force=0.3):
    def figures(overall, force):
        return GapFigures(overall, {"damper_force": force})

    before, floor = figures(0.5, 0.5), figures(0.01, 0.02)
    return Gaps(before, figures(calibrated, 0.4), figures(after, force), floor, 0.2, (0.1, 0.3))


def test_forms_are_tried_where_the_force_of_the_damper_stays_open(wrong_form):
    assert are_forms_due(wrong_form, gaps(0.4, 0.3), "unknown") and are_forms_due(wrong_form, gaps(0.4, 0.3), "known")
    assert not are_forms_due(wrong_form, gaps(0.4, 0.3), "none")
    assert not are_forms_due(wrong_form, gaps(0.4, 0.3, force=0.09), "unknown")
    assert not are_forms_due(wrong_form.on_runs(["run-0"]), gaps(0.4, 0.3), "unknown")


def form(model, shrink, refitted, *beside):
    return DamperForm(model, "bingham", beside, shrink, refitted, {})


@pytest.mark.parametrize("forms, said", [
    ([], ""),
    ([form("ellis", 0.05, 0.0)], ""),
    ([form("ellis", 0.5, 0.05)], "Another form of the damper (`ellis` for `bingham`) takes 50% of what remains."),
    ([form("ellis", 0.5, 0.2)], "Another form of the damper (`ellis` for `bingham`) takes 50% of what remains,"
                                " `bingham` itself with free parameters 20%."),
    ([form("ellis", 0.3, 0.25)], "`bingham` with parameters outside their tolerance takes 25% of what remains."),
    # Effects take a quarter of 0.4; what remains is counted from there.
    ([form("ellis", 0.625, 0.25, "coil.lag")], "Another form of the damper (`ellis` for `bingham`) takes 50% of what"
                                               " remains."),
    ([form("ellis", 0.25, 0.25, "coil.lag"), form("biviscous", 0.3, 0.0)],
     "The form `biviscous` in the place of coil.lag takes 30% of the gap against 25%."),
    ([form("ellis", 0.25, 0.25, "coil.lag"), form("biviscous", 0.3, 0.25)], ""),
    ([form("ellis", 0.25, 0.25, "coil.lag"), form("biviscous", 0.2, 0.0)], ""),
])  # fmt: skip
def test_what_forms_explain_is_one_sentence(forms, said):
    assert describe_forms(forms, gaps(0.4, 0.3), 0.1) == said


def test_a_diagnosis_lists_the_forms_that_were_tried(wrong_form):
    settings = try_only(wrong_form, "bouc_wen").settings
    found = seatsim.diagnose(wrong_form.recording, OTHERS, settings=settings, budget=1200.0, damper_forms=True)
    best = found.alternatives[0]
    content = to_content(found)
    assert best.model == "bouc_wen" and best.shrink > 0.5
    assert content["alternatives"][0]["shrink"] == best.shrink
    assert set(content["alternatives"][0]["parameters"]) == set(TRUE)
    assert tabulate_diagnosis(found)[-1].caption.startswith("Other models of the damper in the place of bingham")
    page = render_report(report_diagnosis(found))
    assert "Other forms of the damper" in page and '<th scope="row">bouc_wen</th>' in page


def test_that_no_form_can_be_judged_is_noted_where_they_were_asked_for(tmp_path):
    problem = record(tmp_path / "rig", runs=1)
    found = seatsim.diagnose(problem.recording, OTHERS, budget=1200.0, damper_forms=True)
    assert found.alternatives == []
    assert describe_obstacle(problem) in found.notes
    assert describe_obstacle(problem) not in seatsim.diagnose(problem.recording, OTHERS, budget=1200.0).notes
