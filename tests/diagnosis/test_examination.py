"""Damaged recordings are named in one sentence, healthy ones with a gap are not called damaged."""

import shutil

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

import seatsim
from seatsim.recordings.quality.coverage import coverage
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.quality.floor_sensor import follows_floor
from seatsim.recordings.recording import load_recording

from .damaged import DAMAGES, DOUBTS, FEEDBACK, GAPS, RATE, at_rest, blurred, edit, rewrite, scaled


@pytest.fixture
def copy(sound, tmp_path):
    return shutil.copytree(sound, tmp_path / "copy")


def found(folder):
    return examine(load_recording(folder)).findings


def errors(folder):
    return [finding.sentence for finding in found(folder) if finding.severity == "error"]


def test_a_healthy_recording_has_nothing_to_say(sound):
    assert found(sound) == []
    refuse(examine(load_recording(sound)))


@pytest.mark.parametrize("name", DAMAGES)
def test_a_damage_is_refused_in_one_sentence_that_names_it(copy, name):
    damage, channel, words = DAMAGES[name]
    rewrite(copy, damage)
    examination = examine(load_recording(copy))
    with pytest.raises(seatsim.InputError) as refused:
        refuse(examination)
    sentence = str(refused.value)
    assert words in sentence
    assert channel is None or channel in sentence
    assert "\n" not in sentence


@pytest.mark.parametrize("name", DOUBTS)
def test_a_doubt_is_said_and_the_diagnosis_goes_on(copy, name):
    damage, channel, words = DOUBTS[name]
    rewrite(copy, damage)
    examination = examine(load_recording(copy))
    assert examination.errors == []
    assert any(words in finding.sentence and channel == finding.channel for finding in examination.findings)


@pytest.mark.parametrize("name", GAPS)
def test_a_gap_is_no_damage(copy, name):
    rewrite(copy, GAPS[name])
    assert errors(copy) == []


@pytest.mark.parametrize(
    ("old", "new"), [("driver_mass: 80.0", "driver_mass: 110.0"), ("alpha_b: 620.0", "alpha_b: 100.0"),
                     ("cushion_stiffness: 60000.0", "cushion_stiffness: 25000.0"), ("rate: 130.0", "rate: 30.0")],
)  # fmt: skip
def test_a_nominal_that_is_far_off_is_no_damage(copy, old, new):
    path = copy / "nominal.yaml"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    assert errors(copy) == []


def test_a_damage_to_one_run_is_placed_there(copy):
    rewrite(copy, scaled("damper_force", -1.0), [copy / "run-2.csv.gz"])
    (finding,) = examine(load_recording(copy)).errors
    assert (finding.kind, finding.run, finding.channel) == ("sign", "run-2", "damper_force")


def test_a_run_at_rest_is_a_warning(copy):
    rewrite(copy, at_rest, [copy / "run-2.csv.gz"])
    assert any(
        "nothing moves" in finding.sentence and (finding.severity, finding.run) == ("warning", "run-2")
        for finding in found(copy)
    )


def test_the_same_data_twice_are_named(copy):
    shutil.copy(copy / "run-1.csv.gz", copy / "run-2.csv.gz")
    assert "run-2: holds the same rows as run-1" in errors(copy)[0]


def test_a_repeat_that_repeats_nothing_is_named(copy):
    frame = pd.read_csv(copy / "run-2.csv.gz")
    frame = frame.assign(floor_acceleration=np.random.default_rng(0).standard_normal(len(frame)).round(4))
    frame.to_csv(copy / "run-2.csv.gz", index=False)
    edit(copy, lambda header: header["runs"][1].update(repeat_of="run-1"))
    assert "run-2: is no repeat of run-1" in errors(copy)[0]


def test_a_true_repeat_is_none(copy):
    edit(copy, lambda header: header["runs"][1].update(repeat_of="run-1"))
    assert errors(copy) == []


def test_one_run_only_is_a_warning(copy):
    edit(copy, lambda header: header["runs"].pop())
    assert any("is the only run" in finding.sentence and finding.severity == "warning" for finding in found(copy))


def test_where_two_damages_explain_it_alike_both_are_named(copy):
    edit(copy, lambda header: [header["channels"].pop(c) for c in
                               ("frame_acceleration", "suspension_displacement", "damper_force")])  # fmt: skip
    rewrite(copy, scaled("floor_acceleration", -1.0))
    (sentence,) = errors(copy)
    assert "floor_acceleration" in sentence
    assert "driver_acceleration" in sentence


def test_noise_that_is_stated_far_too_large_is_said(copy):
    edit(copy, lambda header: header["channels"]["frame_acceleration"].update(noise_rms=0.3))
    assert any((finding.kind, finding.severity) == ("noise", "warning") for finding in found(copy))


def test_the_recordings_of_the_field_are_no_damaged_ones(shared):
    for folder in sorted((shared / "field").glob("field-*"))[::15]:
        assert errors(folder) == []


def test_a_bench_with_a_swapped_force_is_named(tmp_path):
    from seatsim.dampers.bouc_wen import BoucWen
    from seatsim.simulation.damper_bench import bench_force

    rows = np.arange(0.0, 12.0, 0.002)
    fine = np.arange(2 * len(rows) - 1) * 0.001
    generator = np.random.default_rng(3)
    for name, hertz in (("a", 1.5), ("b", 0.7)):
        omega = 2 * np.pi * hertz
        x, v = 0.01 * np.sin(omega * fine), 0.01 * omega * np.cos(omega * fine)
        force = bench_force(BoucWen(), x, v, 0.6, 20.0, 0.002)
        columns = {"displacement": x[::2] + 1e-5 * generator.standard_normal(len(rows)), "coil_current": 0.6,
                   "damper_force": force + 2.0 * generator.standard_normal(len(rows))}  # fmt: skip
        pd.DataFrame(columns).round(7).to_csv(tmp_path / f"{name}.csv.gz", index=False)
    yaml = YAML(typ="safe")
    units = {"displacement": ("m", 1e-5), "coil_current": ("A", 0.0), "damper_force": ("N", 2.0)}
    header = {"rig": "damper_bench", "sample_rate": 500.0, "nominal": "nominal.yaml",
              "runs": [{"name": n, "file": f"{n}.csv.gz"} for n in "ab"],
              "channels": {c: {"unit": u, "noise_rms": n} for c, (u, n) in units.items()}}  # fmt: skip
    nominal = {"damper": {"model": "bouc_wen", "parameters": BoucWen()._asdict()}, "temperature": 20.0,
               "actuator": {"rate": 130.0, "max_current": 1.0}}  # fmt: skip
    yaml.dump(header, tmp_path / "recording.yaml")
    yaml.dump(nominal, tmp_path / "nominal.yaml")
    assert errors(tmp_path) == []
    assert "current stays at 0.6 to 0.6 A" in " ".join(coverage(load_recording(tmp_path)).missing)
    rewrite(tmp_path, scaled("damper_force", -1.0))
    assert "damper_force" in errors(tmp_path)[0]
    rewrite(tmp_path, scaled("damper_force", -0.001))
    assert "in kN" in errors(tmp_path)[0]


def test_coverage_says_what_was_visited_and_what_was_not(copy):
    seen = coverage(load_recording(copy))
    assert seen.seconds == pytest.approx(16.0, abs=0.1)
    assert set(seen.visited) == {"travel", "velocity", "current", "temperature", "driver"}
    table = load_recording(copy).table("run-1")
    assert seen.visited["travel"].high >= np.max(table["suspension_displacement"])
    assert "no run is warmer than 20 degC: thermal fade cannot be judged" in seen.missing
    rewrite(copy, lambda f: f.assign(coil_current=0.4 + 0.01 * np.sin(f.time), damper_temperature=60.0))
    missing = " ".join(coverage(load_recording(copy)).missing)
    assert "remanence" in missing
    assert "thermal fade" not in missing


def test_the_velocity_of_coverage_is_that_of_the_rig(kept_seat_file, sound):
    result = seatsim.run(kept_seat_file, {**FEEDBACK, "solver": {"step": 1.0 / RATE}})
    fast = np.max(np.abs(result["suspension_velocity"]))
    edges = coverage(load_recording(sound)).visited["velocity"]
    assert max(-edges.low, edges.high) == pytest.approx(fast, rel=0.4)


@pytest.mark.parametrize("frequency", [0.5, 2.0, 10.0])
def test_the_floor_of_a_sine_test_is_followed(copy, frequency):
    rewrite(copy, blurred(lambda values: 2.0 * np.sin(2 * np.pi * frequency / RATE * np.arange(len(values)))))
    assert follows_floor(load_recording(copy))
