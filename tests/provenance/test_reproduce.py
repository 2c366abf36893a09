"""Manifests and what is run again of them: of the user's own folders, and of a stranger's."""

import json
import shutil
import sys
from pathlib import Path

import pytest

from seatsim.cli.app import main
from seatsim.provenance import reproduce as reproduction
from seatsim.provenance.reproduce import _is_same, compare_outputs, reproduce
from seatsim.provenance.statement import read_manifest
from seatsim.schema.errors import InputError

from ..text import beside, parse

RECORDING = Path(__file__).resolve().parents[2] / "scenarios" / "data" / "recording"
OUTPUTS = ["comfort.json", "report.html", "running_rms.png", "spectra.png"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A project with a recording beside the folder of results of `comfort`."""
    place = tmp_path_factory.mktemp("project")
    shutil.copytree(RECORDING, place / "rec")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        patch.setattr(sys, "argv", ["seatsim", "comfort", str(place / "rec"), "--hours", "6", "--out", "out/c"])
        with pytest.raises(SystemExit) as stopped:
            main()
    assert stopped.value.code == 0
    return place


@pytest.fixture
def project(made, tmp_path):
    """A copy of that project, elsewhere."""
    return Path(shutil.copytree(made, tmp_path / "moved"))


@pytest.fixture
def never(monkeypatch):
    """Fail where anything is run."""
    monkeypatch.setattr(reproduction.subprocess, "run", lambda *_, **__: pytest.fail("something was run"))


def change(project, **fields):
    path = project / "out" / "c" / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | fields))


def test_a_manifest_holds_command_inputs_and_outputs_by_relative_paths(made):
    text = (made / "out" / "c" / "manifest.json").read_text()
    found = json.loads(text)
    assert str(made) not in text
    assert (found["command"], found["arguments"]) == ("comfort", ["--hours=6.0", "--", "rec"])
    read = [f"../../rec/{name}" for name in ("recording.yaml", "run-1.csv.gz", "run-2.csv.gz")]
    assert [each["path"] for each in found["inputs"]] == read
    assert [each["path"] for each in found["outputs"]] == OUTPUTS
    assert {"seed", "versions", "platform"} <= set(found)


def test_a_moved_project_gives_the_same_bytes_and_code_beside_it_is_not_run(project):
    for name in ("seatsim.py", "numpy.py", "json.py", "sitecustomize.py"):
        (project / name).write_text(f"open({str(project / 'ran')!r}, 'w')")
    found = reproduce(project / "out" / "c")
    assert found.identical and found.compared == OUTPUTS and not found.versions
    assert not (project / "ran").exists()


def test_a_changed_input_is_named_and_nothing_runs(project, never):
    with (project / "rec" / "run-1.csv.gz").open("ab") as file:
        file.write(b" ")
    found = reproduce(project / "out" / "c")
    assert not found.identical
    assert found.differences == [("../../rec/run-1.csv.gz", "this input has changed")]


def test_a_missing_input_is_an_error(project, never):
    (project / "rec" / "run-2.csv.gz").unlink()
    with pytest.raises(InputError, match=r"run-2\.csv\.gz: cannot be read"):
        reproduce(project / "out" / "c")


STRANGE = parse(beside(__file__, "strange_manifests.yaml"))


@pytest.mark.parametrize(("fields", "said"), STRANGE)
def test_what_a_strangers_manifest_may_not_ask_for_is_refused(project, never, fields, said):
    change(project, **fields)
    with pytest.raises(InputError, match=said.replace("\\", "\\\\")):
        reproduce(project / "out" / "c")


def test_a_sweep_of_python_or_one_that_is_not_complete_is_not_run_again(project, never):
    change(project, identity="0", counts={"runs": 9, "pending": 2})
    with pytest.raises(InputError, match="2 runs of this sweep are missing"):
        reproduce(project / "out" / "c")
    path = project / "out" / "c" / "manifest.json"
    path.write_text(json.dumps({"identity": "0"}))
    with pytest.raises(InputError, match=r"holds a sweep that no command.*'seatsim sweep FILE --out OTHER'"):
        reproduce(project / "out" / "c")


@pytest.mark.slow
def test_a_sweep_is_run_again(tmp_path, here, seatsim_command):
    (tmp_path / "s.yaml").write_text("scenario: em5\nvary: {plant.driver_mass: [60, 70], excitation.duration: [1]}\n")
    seatsim_command("sweep", "s.yaml", "--jobs", "1", "--out", "s")
    found = reproduce(tmp_path / "s")
    assert found.identical and found.compared == ["runs/part-000000.parquet"]
    path = tmp_path / "s" / "manifest.json"
    content = json.loads(path.read_text())
    content["configuration"]["files"] = {"road.csv": "0"}
    path.write_text(json.dumps(content))
    assert [each.path for each in reproduce(tmp_path / "s").differences] == ["manifest.json"]


def test_a_folder_of_folders_with_manifests_names_one(project, never):
    with pytest.raises(InputError, match=r"seatsim reproduce .*out/c'"):
        reproduce(project / "out")


@pytest.mark.parametrize(
    ("name", "old", "new", "same"),
    [
        ("fit.json", b'{"r2": 1, "seconds": 2}', b'{"r2": 1, "seconds": 3}', True),
        ("fit.json", b'{"r2": 1, "seconds": 2}', b'{"r2": 2, "seconds": 2}', False),
        ("league.csv", b"model,seconds\na,2\n", b"model,seconds\na,3\n", True),
        ("league.csv", b"model,seconds\na,2\n", b"model,seconds\nb,2\n", False),
    ],
)
def test_measured_times_may_differ_and_nothing_else(name, old, new, same):
    assert _is_same(old, new, name, ["seconds"]) is same
    assert not _is_same(old, new, name, [])


def test_a_file_that_was_changed_is_said(project, monkeypatch):
    def write_again(command, arguments, own_code, directory, out):
        return Path(shutil.copytree(project / "kept", out))

    shutil.copytree(project / "out" / "c", project / "kept")
    monkeypatch.setattr(reproduction, "_run", write_again)
    (project / "out" / "c" / "comfort.json").write_text("{}")
    found = reproduce(project / "out" / "c")
    assert [problem for _, problem in found.differences] == ["was changed after it was written", "differs"]


@pytest.mark.parametrize("name", ["/etc/passwd", "../comfort.json", "a/../../b"])
def test_outputs_outside_the_folder_are_not_read(project, name):
    folder = project / "out" / "c"
    change(project, outputs=[{"path": name, "sha256": "0"}])
    manifest = read_manifest(folder)
    with pytest.raises(InputError, match=r"manifest\.json: output .* lies outside its folder"):
        list(compare_outputs(manifest, folder, manifest, folder))
