"""What a header states of tolerances, the error of the model and what was changed for a run, and what it may not."""

import pytest

from seatsim.recordings.header import Header
from seatsim.recordings.recording import load_recording
from seatsim.schema.errors import InputError

from ..text import beside, cases

GOOD = beside(__file__, "good_header.yaml")
TOLERANCE = "{default: 0.03, plant.driver_mass: 0.1, damper.parameters.c_a: fitted}"


@pytest.fixture
def folder(tmp_path, kept_seat_file):
    law = "controller: {law: replay, current: 0.3}\n"
    lines = kept_seat_file.read_text().splitlines(keepends=True)
    text = "".join(law if line.startswith("controller") else line for line in lines)
    (tmp_path / "nominal.yaml").write_text(text)
    return tmp_path


def load(folder, old="", new=""):
    assert old in GOOD
    (folder / "recording.yaml").write_text(GOOD.replace(old, new))
    return load_recording(folder)


def test_a_header_keeps_what_was_stated(folder):
    recording = load(folder)
    assert recording.header.model_error == 0.05
    assert recording.header.default_tolerance == 0.03
    assert recording.header.own_tolerances == {"plant.driver_mass": 0.1, "damper.parameters.c_a": "fitted"}
    assert recording.runs["c"].set == {"plant.driver_mass": 95.0, "controller.current": 0.0, "temperature": 35.0}
    assert recording.runs["a"].set == {}


@pytest.mark.parametrize("stated", [0.1, "fitted"])
def test_one_tolerance_is_that_of_all_parameters(folder, stated):
    header = load(folder, TOLERANCE, str(stated)).header
    assert header.default_tolerance == header.parameter_tolerance == stated and header.own_tolerances == {}


def test_what_is_left_out_has_its_usual_value(folder):
    header = load(folder, f"parameter_tolerance: {TOLERANCE}\n", "").header
    assert header.default_tolerance == 0.02
    assert load(folder, "model_error: 0.05\n", "").header.model_error is None
    assert Header("seat", 1.0, "n", {"plant.driver_mass": 0.1}).default_tolerance == 0.02


CASES = cases(beside(__file__, "wrong_headers.txt"))


@pytest.mark.parametrize(("old", "new", "words"), CASES, ids=[new for _, new, _ in CASES])
def test_what_is_not_permitted_is_one_error_with_its_place(folder, old, new, words):
    with pytest.raises(InputError) as raised:
        load(folder, old, new)
    text = str(raised.value)
    assert text.startswith(f"{folder / 'recording.yaml'}, line ") and "\n" not in text
    assert all(word in text for word in words), text


@pytest.mark.parametrize("file", ["../a.csv", "/etc/passwd", "sub/../../a.csv", "link.csv", "sub/a.csv"])
def test_a_run_lies_in_the_folder_of_its_recording(folder, tmp_path_factory, file):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "a.csv").write_text("secret")
    (folder / "sub").symlink_to(outside)
    (folder / "link.csv").symlink_to(outside / "a.csv")
    with pytest.raises(InputError, match=r"line 7, runs\.0\.file: .*leads out of the folder.*copy the file into"):
        load(folder, "file: a.csv", f"file: {file}")


def test_a_run_may_lie_in_a_folder_of_its_own_or_be_linked_within(folder):
    (folder / "sub").mkdir()
    (folder / "b.csv").symlink_to(folder / "sub" / "b.csv")
    assert load(folder, "file: a.csv", "file: sub/a.csv").runs["a"].file == "sub/a.csv"
