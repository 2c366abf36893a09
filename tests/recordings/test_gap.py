"""The gap is what its definition says, and it refuses and warns exactly as the diagnosis does."""

import json

import numpy as np
import pandas as pd
import pytest

import seatsim
from seatsim.recordings.gap import gap, measure_gap, pool_runs
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import load_recording
from seatsim.scenario.loading import single

from ..faulty_recordings import FAULTS, NOISE, WARNINGS, edit, rewrite


def refusal(ask):
    with pytest.raises(seatsim.InputError) as refused:
        ask()
    return str(refused.value)


@pytest.mark.parametrize("name", ["no rows", "sign of damper_force"])
def test_gap_and_diagnosis_refuse_a_fault_in_the_sentence_of_the_examination(copy, name):
    rewrite(copy, FAULTS[name][0])
    sentence = refusal(lambda: seatsim.gap(copy / "nominal.yaml", copy))
    assert sentence == refusal(lambda: seatsim.diagnose(copy)) == refusal(lambda: refuse(examine(load_recording(copy))))


def test_a_sound_recording_has_no_notes_and_any_scenario_is_held_against_it(copy, sound_gap):
    assert sound_gap.notes == ()
    other = copy / "other.yaml"
    other.write_text((copy / "nominal.yaml").read_text().replace("driver_mass: 80.0", "driver_mass: 120.0"))
    assert seatsim.gap(other, copy).overall > sound_gap.overall


@pytest.mark.parametrize("logged", [("current_command", "coil_current"), ("coil_current",), ()])
def test_a_law_that_leaves_the_recorded_current_unused_is_a_note(copy, logged):
    lost = {"current_command", "coil_current"} - {*logged}
    edit(copy, lambda header: [header["channels"].pop(name, None) for name in lost])
    own = single(copy / "nominal.yaml", {"controller": {"law": "skyhook", "damping": 1000.0}})
    said = [note for note in gap(own, copy).notes if "law 'skyhook' drives the coil" in note]
    assert len(said) == (1 if logged else 0) and all(name in said[0] for name in logged)
    text = (copy / "nominal.yaml").read_text().replace("law: replay", "law: constant, current: 0.1")
    (copy / "nominal.yaml").write_text(text)
    found = examine(load_recording(copy)).sentences
    assert any("law 'constant' drives the coil" in note for note in found) == bool(logged)


def test_the_command_prints_the_warnings_and_writes_them(copy, tmp_path, seatsim_command):
    fault, _, words = WARNINGS["noisier than stated"]
    rewrite(copy, fault)
    status, out, err = seatsim_command("gap", copy / "nominal.yaml", copy, "--out", tmp_path / "out")
    assert status == 0
    shown = " ".join((out + err).split())
    assert f"note: all runs, driver_acceleration: {words}" in shown
    (note,) = json.loads((tmp_path / "out" / "gap.json").read_text())["notes"]
    assert words in note


def test_the_figures_are_those_of_the_definition(copy):
    """Against the tables alone: a channel moved by three standard deviations of itself has a gap of three."""
    recording, nominal = load_recording(copy), single(copy / "nominal.yaml")
    measured, simulated = pool_runs(nominal, recording, ["run-1", "run-2"])
    tables = [pd.read_csv(copy / f"{run}.csv.gz")[250:] for run in ("run-1", "run-2")]
    found = measure_gap(nominal, recording)
    for name, values in measured.items():
        pooled = np.concatenate([table[name].to_numpy() for table in tables])
        assert np.array_equal(values, pooled)
        error = np.sqrt(np.mean((pooled - simulated[name]) ** 2))
        assert found.channels[name] == pytest.approx(error / np.std(pooled), rel=1e-12)
        assert found.floor.channels[name] == pytest.approx(NOISE[name] / np.std(pooled), rel=1e-12)
    assert found.overall**2 == pytest.approx(np.mean(np.square(list(found.channels.values()))), rel=1e-12)
    assert found.floor.overall < found.overall < 2 * found.floor.overall
    k = "driver_acceleration"
    rewrite(copy, lambda frame: frame.assign(**{k: frame[k] + 3.0 * np.std(measured[k])}))
    assert measure_gap(nominal, recording).channels[k] == pytest.approx(3.0, rel=1e-2)


def test_channels_that_hardly_stand_above_their_noise_are_not_compared(copy):
    recording, nominal = load_recording(copy), single(copy / "nominal.yaml")
    assert "damper_force" in measure_gap(nominal, recording).channels
    force = pool_runs(nominal, recording, ["run-1"])[0]["damper_force"]
    for factor, compared in ((0.34, False), (0.32, True)):
        noise = factor * float(np.std(force))
        edit(copy, lambda header, noise=noise: header["channels"]["damper_force"].update(noise_rms=noise))
        assert ("damper_force" in measure_gap(nominal, load_recording(copy), ["run-1"]).channels) is compared
    edit(copy, lambda header: [entry.update(noise_rms=1e6) for entry in header["channels"].values()])
    with pytest.raises(seatsim.InputError, match="nothing to compare"):
        measure_gap(nominal, load_recording(copy))
