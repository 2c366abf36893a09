"""Folders from strangers: nothing in them is run, whatever it is called and wherever seatsim was started.

Every trap leaves a mark where it is run: a file in the folder `marks`. A trap that would be read as data names the same
mark in the form that a careless reader would execute.
"""

import io
import os
import pickle
import shutil
import subprocess
import sys
from contextlib import chdir, suppress
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from seatsim.importing.inspection import inspect_file
from seatsim.recordings.recording import load_recording
from seatsim.scenario.loading import load
from seatsim.schema.errors import SeatsimError

from ..text import words

ROOT = Path(__file__).resolve().parents[2]
MODULES = tuple(
    words("""
    numexpr bottleneck sitecustomize usercustomize conftest evil sympy mosek gurobipy pickle random selectors
    numpy pandas seatsim_plugins controllers dask h5py
""")
)
"""Modules that something of seatsim, of its libraries or of Python imports by name, or a plug-in would."""


class Trap:
    """What leaves a mark when it is unpickled."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return os.mkdir, (str(self.mark),)


@pytest.fixture
def marks(tmp_path):
    folder = tmp_path / "marks"
    folder.mkdir()
    return folder


@pytest.fixture
def strange(tmp_path, marks):
    """The recording of a stranger, with a trap for every name that might be imported from its folder."""
    folder = shutil.copytree(ROOT / "scenarios" / "data" / "recording", tmp_path / "strange")
    for name in MODULES:
        (folder / f"{name}.py").write_text(f"import os\nos.mkdir({str(marks / name)!r})\n")
    for name in ("rich", "importlib_metadata"):
        (folder / name).mkdir()
        (folder / name / "__init__.py").write_text(f"import os\nos.mkdir({str(marks / name)!r})\n")
    (folder / "paths.pth").write_text(f"import os; os.mkdir({str(marks / 'pth')!r})\n")
    info = folder / "evil-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: evil\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[seatsim.plugins]\nevil = evil\n")
    return folder


def started(arguments, folder):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.run(arguments, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_commands_that_are_started_in_the_folder_run_nothing_of_it(strange, marks, tmp_path):
    command = [sys.executable, "-m", "seatsim", "gap", "nominal.yaml", ".", "--out", str(tmp_path / "out")]
    done = started(command, strange)
    assert done.returncode == 0, done.stderr
    assert not list(marks.iterdir())


OWN = """
from typing import NamedTuple
from seatsim.rig.control import law
@law("own_law")
class OwnLaw(NamedTuple):
    'A law of the user.'
    def wanted_current(self, y, state):
        return 0.5
"""
SCRIPT = """
from pathlib import Path
import seatsim
from seatsim.scenario.describe import describe
from seatsim.schema.processes import run_jobs
if __name__ == '__main__':
    seatsim.use(Path(__file__).with_name('own.py'))
    print(*run_jobs(describe, [('own_law',), ('road',)], 2))
"""


def test_worker_processes_run_the_files_in_use_and_nothing_of_the_folder_they_are_started_in(strange, marks, tmp_path):
    folder = tmp_path / "script"
    folder.mkdir()
    for name, text in {"own": OWN, "start": SCRIPT}.items():
        (folder / f"{name}.py").write_text(text)
    done = started([sys.executable, str(folder / "start.py")], strange)
    assert "A law of the user." in done.stdout and "road (excitation)" in done.stdout, done.stderr
    assert not list(marks.iterdir())


@pytest.mark.parametrize("name", [".numba_config.yaml", "matplotlibrc"])
def test_settings_of_libraries_in_the_folder_are_not_obeyed(here, name, seatsim_command):
    (here / name).write_text("cache_dir: .\n")
    status, _, said = seatsim_command("describe", "road")
    assert status == 2 and said.startswith(f"error: {name}: changes how libraries work")


@pytest.mark.parametrize(
    "text",
    [
        "!!python/object/apply:os.mkdir [{mark}]",
        "!!python/object/new:os.mkdir [{mark}]",
        "!!python/name:evil.X",
        "!!python/module:evil",
        "{{model: 'evil:X'}}",
        "{{model: 'os:mkdir'}}",
        "{{model: '../strange/evil:X'}}",
        "{{model: 'evil.py:X'}}",
        "{{model: '$(mkdir {mark}):X'}}",
        '{{model: \'__import__("os").mkdir("{mark}")\'}}',
    ],
)
def test_texts_of_yaml_files_are_not_run(strange, marks, text):
    nominal = (strange / "nominal.yaml").read_text()
    start, end = nominal.index("damper:"), nominal.index("excitation:")
    written = text.format(mark=marks / "yaml")
    (strange / "nominal.yaml").write_text(f"{nominal[:start]}damper: {written}\n{nominal[end:]}")
    with chdir(strange), pytest.raises(SeatsimError):
        load("nominal.yaml")
    header = (strange / "recording.yaml").read_text()
    (strange / "recording.yaml").write_text(f"{header}\nnote: {written}\n")
    with suppress(SeatsimError):
        load_recording(strange)
    assert not list(marks.iterdir())


def pickled(path, mark):
    path.write_bytes(pickle.dumps(Trap(mark)))


def archive(path, mark):
    np.savez(path, data=np.array([Trap(mark)], dtype=object))


def array(path, mark):
    with path.open("wb") as file:
        np.save(file, np.array([Trap(mark)], dtype=object))


def matlab(path, mark):
    scipy.io.savemat(path, {"data": np.frombuffer(pickle.dumps(Trap(mark)), dtype=np.uint8)})


def hdf5(path, mark):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file["data"] = np.void(pickle.dumps(Trap(mark)))
        file["data"].attrs["CLASS"] = "PICKLE"
        file["linked"] = h5py.ExternalLink("evil.py", "/")


def parquet(path, mark):
    import pyarrow as pa
    from pyarrow import parquet as writer

    metadata = {"ARROW:extension:name": "arrow.py_extension_type", "ARROW:extension:metadata": pickle.dumps(Trap(mark))}
    field = pa.field("a", pa.float64(), metadata=metadata)
    writer.write_table(pa.table([pa.array([1.0, 2.0])], pa.schema([field])), path)


def formula(path, mark):
    asammdf = pytest.importorskip("asammdf")
    conversion = {"formula": f"X1 + __import__('os').mkdir('{mark}')"}
    signal = asammdf.Signal(np.arange(9, dtype=np.int32), np.arange(9.0), name="a", conversion=conversion)
    content = io.BytesIO()
    with asammdf.MDF() as file:
        file.append([signal])
        file.save(content)
    path.write_bytes(content.getvalue())


FILES = words("a.pkl a.csv a.npz a.npy a.mat a.h5 a.parquet a.mf4")
TRAPS = dict(zip(FILES, (pickled, pickled, archive, array, matlab, hdf5, parquet, formula), strict=True)) | {
    "$(mkdir marks;cd marks).csv": lambda path, mark: path.write_text(f"`mkdir {mark}`,=cmd|' /C'!A0\n1,2\n3,4\n")
}


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("name", TRAPS)
def test_data_files_are_read_and_not_run(strange, marks, monkeypatch, name):
    # Where sympy is installed, asammdf runs what numexpr refuses.
    monkeypatch.setattr("asammdf.blocks.v4_blocks.lambdify", lambda *_, **__: os.mkdir(marks / "sympy"))
    TRAPS[name](strange / name, marks / "data")
    with chdir(strange):
        try:
            inspect_file(Path(name))
        except SeatsimError as error:
            assert "\n" not in str(error)
    assert not list(marks.iterdir())
