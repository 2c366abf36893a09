"""The gap to be expected: by arithmetic on signals, and through the command on a recording with and without outputs."""

import json

import numpy as np
import pytest

import seatsim
from seatsim.recordings import prediction
from seatsim.recordings.gap import pool_runs
from seatsim.recordings.model_error import measure_model_error
from seatsim.recordings.prediction import predict_gap
from seatsim.recordings.recording import load_recording
from seatsim.recordings.replay import COMPARED
from seatsim.scenario.loading import single
from seatsim.schema.content import to_content

from ..faulty_recordings import edit

RATE, N = 200.0, 20000
OUTPUTS = COMPARED["seat"]


def white(seed, size=1.0):
    return size * np.random.default_rng(seed).standard_normal(N)


def combine(error, before, after, shifted=()):
    rigs = prediction.SimulatedRigs(RATE, {"x": before}, {"x": after}, [{"x": each} for each in shifted])
    return prediction._combine(error, rigs, "here")


@pytest.fixture
def error():
    """Two runs whose residuals are a tenth and a fifth of what was measured, and no noise."""
    runs = []
    for run, share in (("a", 0.1), ("b", 0.2)):
        simulated = white(run == "b")
        runs.append((run, {"x": simulated + share * white(9)}, {"x": simulated}))
    return measure_model_error(runs, {"x": 0.0}, RATE, 100.0)


def test_before_has_what_the_effects_change_beside_what_is_missed(error):
    after, change = white(3), white(4, 0.5)
    found = combine(error, after - change, after)
    missed = 0.15
    assert found.after == pytest.approx(missed, rel=0.05)
    assert found.before == pytest.approx(np.hypot(missed, 0.5), rel=0.03)
    assert found.shrink == pytest.approx(1.0 - missed / np.hypot(missed, 0.5), abs=0.01)
    assert found.channels == {"x": (pytest.approx(found.before), pytest.approx(found.after))}
    low, high = found.shrink_interval
    # Between a residual of a tenth and one of a fifth lies a factor of two, of which the interval holds more.
    assert low < 1.0 - 0.2 / np.hypot(0.2, 0.5) < found.shrink < 1.0 - 0.1 / np.hypot(0.1, 0.5) < high < 1.0


def test_what_is_left_as_it_is_does_not_shrink(error):
    found = combine(error, white(3), white(3))
    assert (found.shrink, found.shrink_interval) == (0.0, (0.0, 0.0)) and found.before == found.after > 0.0


def test_doubtful_parameters_and_unlike_runs_widen_the_interval(error):
    after, before = white(3), white(3) - white(4, 0.5)
    sure = combine(error, before, after)
    doubtful = combine(error, before, after, [after + white(5, 0.3)])
    assert doubtful.shrink == sure.shrink and doubtful.shrink_interval[0] < sure.shrink_interval[0] - 0.1
    runs = [(run, {"x": white(0) + 0.15 * white(9)}, {"x": white(0)}) for run in "ab"]
    alike = measure_model_error(runs, {"x": 0.0}, RATE, 100.0)
    assert np.ptp(combine(alike, before, after).shrink_interval) < 0.5 * np.ptp(sure.shrink_interval)
    alone = measure_model_error([("a", {"x": white(0) + 0.15 * white(9)}, {"x": white(0)})], {"x": 0.0}, RATE, 100.0)
    assert np.ptp(combine(alone, before, after).shrink_interval) > np.ptp(combine(alike, before, after).shrink_interval)


def test_channels_that_do_not_stand_above_their_noise_are_left_out():
    error = measure_model_error([("a", {"x": white(0)}, {"x": white(0)})], {"x": 0.5}, RATE, 100.0)
    with pytest.raises(seatsim.InputError, match="no channel of the diagnosis is to stand above its noise"):
        combine(error, white(3), white(3))


def write_diagnosis(folder, recording, scenario):
    """Write what a diagnosis would state of a scenario on a recording."""
    runs = [(run, *pool_runs(scenario, recording, [run])) for run in recording.runs]
    noise = {name: recording.channels[name].noise_rms for name in runs[0][1]}
    error = measure_model_error(runs, noise, recording.header.sample_rate, 100.0)
    path = folder / "diagnosis.json"
    path.write_text(json.dumps({"model_error": to_content(error), "causes": []}))
    return path


@pytest.fixture
def heavier(copy):
    """The sound recording with a nominal whose driver is too light; the scenario that fits, and its diagnosis."""
    right = copy / "augmented.yaml"
    right.write_text((copy / "nominal.yaml").read_text())
    light = (copy / "nominal.yaml").read_text().replace("driver_mass: 80.0", "driver_mass: 60.0")
    (copy / "nominal.yaml").write_text(light)
    recording = load_recording(copy)
    return copy, right, write_diagnosis(copy, recording, single(right))


def test_a_scenario_without_what_the_diagnosis_found_is_not_the_augmented_one(heavier):
    copy, right, diagnosis = heavier
    cause = {"effect": "suspension.friction", "parameters": {"force": {"value": 30.0, "std": 1.0, "unit": "N"}}}
    content = json.loads(diagnosis.read_text()) | {"causes": [cause], "selected": [cause["effect"]]}
    diagnosis.write_text(json.dumps(content))
    with pytest.raises(
        seatsim.InputError, match=r"lacks suspension.friction, which .* found; .* give .*augmented.yaml"
    ):
        predict_gap(copy / "nominal.yaml", copy, diagnosis)
    entry = "\neffects: [{effect: suspension.friction, parameters: {force: 30.0}}]\n"
    right.write_text(right.read_text() + entry)
    assert predict_gap(right, copy, diagnosis).after > 0.0


def test_the_command_shows_both_and_writes_them(heavier, tmp_path, seatsim_command):
    copy, right, diagnosis = heavier
    status, shown, _ = seatsim_command("gap", right, copy, "--predict", diagnosis, "--out", tmp_path / "out")
    assert status == 0
    content = json.loads((tmp_path / "out" / "gap.json").read_text())
    predicted, measured = content["predicted"], content["measured"]
    assert content["overall"] == measured["after"] and set(content["channels"]) == set(predicted["channels"])
    for part in ("before", "after"):
        assert predicted[part] == pytest.approx(measured[part], rel=0.05)
    assert predicted["shrink"] == pytest.approx(measured["shrink"], abs=0.05)
    low, high = predicted["shrink_interval"]
    assert low <= predicted["shrink"] <= high
    assert f"expected shrink {predicted['shrink']:.2f}" in shown
    edit(copy, lambda header: [header["channels"].pop(name, None) for name in OUTPUTS])
    assert seatsim_command("gap", right, copy, "--predict", diagnosis, "--out", tmp_path / "blind")[0] == 0
    content = json.loads((tmp_path / "blind" / "gap.json").read_text())
    assert content["overall"] is None and content["channels"] == {} and "measured" not in content
    assert content["predicted"]["shrink"] == pytest.approx(predicted["shrink"], abs=0.01)


def test_what_is_no_diagnosis_is_refused_and_nothing_is_written(heavier, tmp_path, seatsim_command):
    copy, right, _ = heavier
    for name, text in (("no.json", "{"), ("old.json", "{}"), ("list.json", "[]")):
        (tmp_path / name).write_text(text)
        call = seatsim_command("gap", right, copy, "--predict", tmp_path / name, "--out", tmp_path / "out")
        assert call[0] == 2 and name in (call[1] + call[2]).replace("\n", "") and not (tmp_path / "out").exists()
