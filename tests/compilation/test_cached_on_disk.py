"""The cache of compiled code: an edited model never runs stale, an unedited one is not compiled again."""

import json
import os
import subprocess
import sys

import pytest

MODEL = """
from typing import NamedTuple
import numba
from slope import GAIN, slope
import seatsim.kernel.generic

@numba.njit
def doubled(v):
    return 2.0 * v

class Model(NamedTuple):
    c: float
    def force(self, x, v, i, scaling, z):
        return 1.0 * doubled(self.c * slope(v)) + GAIN
"""
SLOPE = """
import numba
GAIN = 0.5
@numba.njit
def slope(v):
    return 1.0 * v
"""
LOOP = """
from seatsim.kernel.generic import force

def evaluate(model, v):
    return force(model, 0.0, v, 0.0, 0.0, ())
"""
CALL = """
import sys
from pathlib import Path
from model import Model
import loop
from seatsim.compilation.cached import compiled
{before}
function = compiled(loop.evaluate, (Model,))
print(function(Model(3.0), 1.0), sum(function.stats.cache_hits.values()))
"""
# Imports and warms up numba once; each line of its input is then run in a process of its own.
NURSERY = """
import json, os, sys
import numba
import seatsim.compilation.cached, seatsim.kernel.generic
numba.njit(lambda v: 2.0 * v)(1.0)
sys.path.insert(0, "")
for line in sys.stdin:
    folder, cache, code = json.loads(line)
    if os.fork() == 0:
        os.chdir(folder)
        os.environ["SEATSIM_CACHE_DIR"] = cache
        exec(code, {"__name__": "__main__"})
        sys.stdout.flush()
        os._exit(0)
    assert os.wait()[1] == 0
"""
HERE = 6.5


@pytest.fixture(scope="module")
def nursery():
    command = [sys.executable, "-B", "-c", NURSERY]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        yield process
        process.stdin.close()


@pytest.fixture
def model(tmp_path, nursery):
    """A folder with a user's model, and a function that runs it in a process of its own: (value, loaded from disk)."""
    for name, text in {"model": MODEL, "slope": SLOPE, "loop": LOOP}.items():
        (tmp_path / f"{name}.py").write_text(text)

    def call(before="", cache=tmp_path / "cache"):
        print(json.dumps([str(tmp_path), str(cache), CALL.format(before=before)]), file=nursery.stdin, flush=True)
        value, hits = nursery.stdout.readline().split()
        return float(value), int(hits) > 0

    call.folder = tmp_path
    return call


def edit(file, old, new):
    """Replace text by as long a one and put the times back, so that neither size nor time tells."""
    before = file.stat()
    text = file.read_text()
    assert old in text and len(old) == len(new)
    file.write_text(text.replace(old, new))
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))


def test_an_unedited_model_is_loaded(model):
    assert model() == (HERE, False)
    assert model() == (HERE, True)


def test_an_edited_source_is_compiled_anew_and_found_again_once_it_is_as_it_was(model):
    assert model()[0] == HERE
    for file, old, new, value in (
        ("model.py", "1.0 * d", "2.0 * d", 12.5),
        ("model.py", "2.0 * v", "3.0 * v", 9.5),
        ("slope.py", "1.0 *", "4.0 *", 24.5),
        ("slope.py", "GAIN = 0.5", "GAIN = 0.7", 6.7),
        ("loop.py", "0.0, v,", "0.0,-v,", -5.5),
    ):
        edit(model.folder / file, old, new)
        assert model() == (pytest.approx(value), False), (file, new)
        edit(model.folder / file, new, old)
    assert model() == (HERE, True)


@pytest.mark.parametrize("constant", ["(float(np.loadtxt('gain')),)", "np.loadtxt('gain', ndmin=1)"])
def test_a_constant_of_another_file_does_not_run_stale(model, constant):
    (model.folder / "slope.py").write_text("import numpy as np" + SLOPE.replace("0.5", constant))
    (model.folder / "model.py").write_text(MODEL.replace("+ GAIN", "+ GAIN[0]"))
    for gain in (0.5, 0.7):
        (model.folder / "gain").write_text(str(gain))
        assert model() == (pytest.approx(6.0 + gain), False)


def test_a_source_edited_after_its_import_does_not_mislead_later_runs(model):
    change = "p = Path('model.py'); p.write_text(p.read_text().replace('1.0 *', '2.0 *'))"
    assert model(before=change)[0] == HERE
    assert model() == (12.5, False)


def test_a_reloaded_model_is_compiled_anew(model):
    reload = (
        "compiled(loop.evaluate, (Model,))(Model(3.0), 1.0)\n"
        "p = Path('model.py'); p.write_text(p.read_text().replace('1.0 *', '2.0 *'))\n"
        "import importlib; Model = importlib.reload(sys.modules['model']).Model"
    )
    assert model(before=reload)[0] == 12.5


def test_without_a_folder_nothing_is_kept(model):
    (model.folder / "file").touch()
    for _ in range(2):
        assert model(cache=model.folder / "file" / "cache") == (HERE, False)
    assert not list(model.folder.rglob("*.nb[ic]"))


@pytest.mark.slow
def test_a_model_without_a_source_is_not_kept(model):
    inline = (
        "from typing import NamedTuple\n"
        "class Model(NamedTuple):\n    c: float\n"
        "    def force(self, x, v, i, scaling, z):\n        return self.c * {}.0 * v"
    )
    assert model(before=inline.format(1)) == (3.0, False)
    assert model(before=inline.format(2)) == (6.0, False)
