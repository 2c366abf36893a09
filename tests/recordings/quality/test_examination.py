"""Faults of data are named in one sentence; a recording with a gap is not called faulty."""

import shutil
from typing import get_args

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

from seatsim.recordings.header import Refusal
from seatsim.recordings.quality.coverage import measure_coverage
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import load_recording
from seatsim.schema.errors import InputError

from ...faulty_recordings import FAULTS, SOUND_GAPS, WARNINGS, at_rest, edit, rewrite, scaled


def found(folder):
    return examine(load_recording(folder)).issues


def errors(folder):
    return [issue.sentence for issue in found(folder) if issue.severity == "error"]


def test_a_sound_recording_has_nothing_to_say(sound):
    assert found(sound) == []
    refuse(examine(load_recording(sound)))


@pytest.mark.parametrize("name", WARNINGS)
def test_a_warning_is_said_and_refuses_nothing(copy, name):
    fault, channel, words = WARNINGS[name]
    rewrite(copy, fault)
    examination = examine(load_recording(copy))
    assert examination.errors == []
    assert any(words in issue.sentence and channel == issue.channel for issue in examination.issues)


@pytest.mark.parametrize("name", SOUND_GAPS)
def test_a_gap_is_no_fault(copy, name):
    rewrite(copy, SOUND_GAPS[name])
    assert errors(copy) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("driver_mass: 80.0", "driver_mass: 110.0"),
        ("alpha_b: 620.0", "alpha_b: 100.0"),
        ("cushion_stiffness: 60000.0", "cushion_stiffness: 25000.0"),
        ("rate: 130.0", "rate: 30.0"),
    ],
)
def test_a_nominal_that_is_far_off_is_no_fault(copy, old, new):
    path = copy / "nominal.yaml"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    assert errors(copy) == []


def test_what_its_owner_accepts_is_a_note_and_the_later_checks_are_made(copy):
    rewrite(copy, scaled("damper_force", -1.0))
    (error,) = examine(load_recording(copy)).errors
    assert error.sentence.endswith("if it is right as it is, write accept: [sign] in recording.yaml")
    edit(copy, lambda header: header.update(accept=["sign"]))
    examination = examine(load_recording(copy))
    assert examination.errors == [] and refuse(examination) is None
    assert any(issue.severity == "note" and "accepted by its owner" in issue.sentence for issue in examination.issues)


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_refused_in_one_sentence_that_names_it_and_the_check_that_may_be_overruled(copy, name):
    fault, channel, words = FAULTS[name]
    rewrite(copy, fault)
    examination = examine(load_recording(copy))
    with pytest.raises(InputError) as refused:
        refuse(examination)
    assert words in str(refused.value) and "\n" not in str(refused.value)
    assert channel is None or channel in str(refused.value)
    for issue in examination.errors:
        assert issue.kind == "unreadable" or f"write accept: [{issue.kind}]" in issue.sentence
        assert issue.kind == "unreadable" or issue.kind in get_args(Refusal)


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (["lat"], "'lat' is not permitted (did you mean 'late'?); permitted: rate, jump"),
        ("late", "must be a list, such as [late]"),
    ],
)
def test_an_unknown_check_cannot_be_accepted(copy, stated, said):
    edit(copy, lambda header: header.update(accept=stated))
    with pytest.raises(InputError) as refused:
        load_recording(copy)
    assert said in str(refused.value)


def test_a_fault_of_one_run_is_placed_there(copy):
    rewrite(copy, scaled("damper_force", -1.0), [copy / "run-2.csv.gz"])
    (issue,) = examine(load_recording(copy)).errors
    assert (issue.kind, issue.run, issue.channel) == ("sign", "run-2", "damper_force")


def test_a_run_at_rest_is_a_warning(copy):
    rewrite(copy, at_rest, [copy / "run-2.csv.gz"])
    assert any(
        "nothing moves" in issue.sentence and (issue.severity, issue.run) == ("warning", "run-2")
        for issue in found(copy)
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
    assert any("is the only run" in issue.sentence and issue.severity == "warning" for issue in found(copy))


def test_where_two_faults_explain_it_alike_both_are_named(copy):
    edit(
        copy,
        lambda header: [
            header["channels"].pop(c) for c in ("frame_acceleration", "suspension_displacement", "damper_force")
        ],
    )
    rewrite(copy, scaled("floor_acceleration", -1.0))
    (sentence,) = errors(copy)
    assert "floor_acceleration" in sentence
    assert "driver_acceleration" in sentence


def test_noise_that_is_stated_far_too_large_is_said(copy):
    edit(copy, lambda header: header["channels"]["frame_acceleration"].update(noise_rms=0.3))
    assert any((issue.kind, issue.severity) == ("noise", "warning") for issue in found(copy))


def test_the_recordings_of_the_field_are_not_faulty(shared):
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
        columns = {
            "displacement": x[::2] + 1e-5 * generator.standard_normal(len(rows)),
            "coil_current": 0.6,
            "damper_force": force + 2.0 * generator.standard_normal(len(rows)),
        }
        pd.DataFrame(columns).round(7).to_csv(tmp_path / f"{name}.csv.gz", index=False)
    yaml = YAML(typ="safe")
    units = {"displacement": ("m", 1e-5), "coil_current": ("A", 0.0), "damper_force": ("N", 2.0)}
    header = {
        "rig": "damper_bench",
        "sample_rate": 500.0,
        "nominal": "nominal.yaml",
        "runs": [{"name": n, "file": f"{n}.csv.gz"} for n in "ab"],
        "channels": {c: {"unit": u, "noise_rms": n} for c, (u, n) in units.items()},
    }
    nominal = {
        "damper": {"model": "bouc_wen", "parameters": BoucWen()._asdict()},
        "temperature": 20.0,
        "actuator": {"rate": 130.0, "max_current": 1.0},
    }
    yaml.dump(header, tmp_path / "recording.yaml")
    yaml.dump(nominal, tmp_path / "nominal.yaml")
    assert errors(tmp_path) == []
    assert "current stays at 0.6 to 0.6 A" in " ".join(measure_coverage(load_recording(tmp_path)).missing)
    rewrite(tmp_path, scaled("damper_force", -1.0))
    assert "damper_force" in errors(tmp_path)[0]
    rewrite(tmp_path, scaled("damper_force", -0.001))
    assert "in kN" in errors(tmp_path)[0]
