"""Faults of data are named in one sentence; a recording with a gap is not called faulty."""

import shutil
from typing import get_args

import pytest

from seatsim.recordings.header import Refusal
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import load_recording
from seatsim.schema.errors import InputError

from ...faulty_recordings import FAULTS, WARNINGS, edit, rewrite, scaled


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


def test_where_two_faults_explain_it_alike_both_are_named(copy):
    lost = ("frame_acceleration", "suspension_displacement", "damper_force")
    edit(copy, lambda header: [header["channels"].pop(channel) for channel in lost])
    rewrite(copy, scaled("floor_acceleration", -1.0))
    (sentence,) = errors(copy)
    assert "floor_acceleration" in sentence
    assert "driver_acceleration" in sentence


def test_the_recordings_of_the_field_are_not_faulty(shared):
    for folder in sorted((shared / "field").glob("field-*"))[::15]:
        assert errors(folder) == []


def test_a_bench_with_a_swapped_force_is_named(bench, tmp_path):
    folder = shutil.copytree(bench, tmp_path / "bench")
    assert errors(folder) == []
    rewrite(folder, scaled("damper_force", -1.0))
    assert "damper_force" in errors(folder)[0]
    rewrite(folder, scaled("damper_force", -0.001))
    assert "in kN" in errors(folder)[0]
