"""Own code: run where its file is named, never because it lies beside a scenario or a recording."""

import os
import shutil
import subprocess
import sys
from contextlib import ExitStack, chdir
from pathlib import Path

import pytest

import seatsim
from seatsim.schema.modules import MissingModuleError, import_named, use, use_all, used_files
from seatsim.schema.registry import find, names

ROOT = Path(__file__).resolve().parents[2]
POWER_LAW = """\
from typing import Annotated, NamedTuple
from seatsim.dampers.base import damper
from seatsim.schema.fields import param

@damper("power_law", source="a test", current_order=1)
class PowerLaw(NamedTuple):
    a: Annotated[float, param("N s/m", "damping at zero current", low=0)] = 300.0
    def force(self, x, v, i, scaling, z):
        return self.a * scaling.viscous * v
"""
MALICIOUS = "from pathlib import Path\nPath(__file__).with_name('stolen').touch()\n" + POWER_LAW


@pytest.fixture
def searched():
    """Work in a folder that Python itself searches first, as in a notebook or with `python -c`."""
    with ExitStack() as ends:

        def start(folder):
            ends.enter_context(chdir(folder))
            sys.path.insert(0, "")
            ends.callback(sys.path.remove, "")

        yield start


@pytest.fixture
def power_law(tmp_path, forget_own_code):
    """A file of the user's own."""
    file = tmp_path / "mine" / "powerlaw.py"
    file.parent.mkdir()
    file.write_text(POWER_LAW)
    return file


@pytest.fixture
def strange(tmp_path, forget_own_code):
    """A recording from a stranger whose nominal scenario names the module that lies beside it."""
    folder = shutil.copytree(ROOT / "scenarios" / "data" / "recording", tmp_path / "strange")
    nominal = (folder / "nominal.yaml").read_text()
    start, end = nominal.index("damper:"), nominal.index("excitation:")
    (folder / "nominal.yaml").write_text(f"{nominal[:start]}damper: {{model: powerlaw:PowerLaw}}\n{nominal[end:]}")
    (folder / "powerlaw.py").write_text(MALICIOUS)
    return folder


def command(name, folder, out):
    """A command that a scenario or a recording of the folder could make run its code."""
    nominal = folder / "nominal.yaml"
    given = {"gap": (nominal, folder), "diagnose": (folder,), "compare": (nominal, nominal)}
    return name, *given.get(name, (nominal,)), "--out", out


NAMES = ("gap", "diagnose", "run", "compare", "synthesise")


@pytest.mark.parametrize(("name", "inside"), [*((name, False) for name in NAMES), ("gap", True), ("run", True)])
def test_a_module_beside_a_recording_is_not_run(name, inside, strange, tmp_path, seatsim_command, searched):
    searched(strange if inside else tmp_path)
    folder, out = (Path("."), tmp_path / "out") if inside else (Path("strange"), tmp_path / "out")
    arguments = command(name, folder, out)
    status, _, error = seatsim_command(*arguments)
    assert status == 2
    assert "line" in error and "damper.model" in error and "no module 'powerlaw' is installed" in error
    words = " ".join(map(str, arguments))
    assert f"seatsim {words} --with {folder / 'powerlaw.py'}" in " ".join(error.split())
    assert not (strange / "stolen").exists() and not out.exists()
    assert "powerlaw" not in sys.modules
    assert all(Path(entry or ".").resolve() != strange for entry in sys.path[1:])


def test_python_started_in_the_folder_of_a_recording_does_not_run_its_module(strange):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    for start in (["-m", "seatsim", "run", "nominal.yaml"], ["-c", "import seatsim; seatsim.load('nominal.yaml')"]):
        words = [sys.executable, *start]
        done = subprocess.run(words, cwd=strange, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode != 0
        assert "seatsim.use('powerlaw.py')" in done.stderr
        assert not (strange / "stolen").exists()


def test_a_named_file_replays_a_recording(strange, seatsim_command):
    file = strange / "powerlaw.py"
    arguments = ("gap", strange / "nominal.yaml", strange, "--with", file, "--out", strange / "out")
    assert seatsim_command(*arguments)[0] == 0
    assert (strange / "out" / "gap.json").exists()
    assert (strange / "stolen").exists(), "the file that was named is the one that was run"


def test_use_returns_the_module_and_registers_its_classes(power_law):
    module = use(power_law)
    assert find("damper", "power_law") is module.PowerLaw is find("damper", "powerlaw:PowerLaw")
    assert "power_law" in names("damper")
    assert used_files() == (power_law,)
    assert use(str(power_law)) is module


def test_a_file_that_was_edited_is_loaded_again(power_law):
    first = use(power_law)
    power_law.write_text(POWER_LAW.replace("= 300.0", "= 400.0"))
    second = use(power_law)
    assert (first.PowerLaw().a, second.PowerLaw().a) == (300.0, 400.0)
    assert find("damper", "powerlaw:PowerLaw") is second.PowerLaw
    assert used_files() == (power_law,)


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("absent.py", None, "cannot be read: No such file"),
        ("law.txt", "", "not a Python file"),
        ("my-law.py", "", "its name has letters, digits and _"),
        ("numpy.py", "", "'numpy' is the name of another module"),
        ("antigravity.py", "", "'antigravity' is the name of another module"),
        ("sys.py", "", "'sys' is the name of another module, built in"),
        ("broken.py", "a = 1\n1 / 0\n", r"broken.py, line 2 \(1 / 0\): cannot be imported: ZeroDivisionError"),
        ("unclosed.py", "a = 1\nb = (\n", r"unclosed.py, line 2 \(b = \(\): cannot be imported: SyntaxError"),
        ("asking.py", "import nowhere_at_all\n", "line 1 .*No module named 'nowhere_at_all'$"),
        ("asking.py", "import other\n", "name other.py before it: --with .*other.py"),
        ("taking.py", POWER_LAW.replace("power_law", "bouc_wen"), "damper 'bouc_wen' is there already"),
    ],
)
def test_a_file_that_cannot_be_used_is_a_clear_error(tmp_path, forget_own_code, name, text, problem):
    (tmp_path / "other.py").write_text("")
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(seatsim.InputError, match=problem):
        use(tmp_path / name)
    assert used_files() == ()


def test_two_files_of_one_name_are_not_taken_for_each_other(power_law, tmp_path):
    use(power_law)
    other = tmp_path / "powerlaw.py"
    other.write_text(POWER_LAW)
    with pytest.raises(seatsim.InputError, match=r"'powerlaw' is the name of another module, .*mine"):
        use(other)


def test_a_file_may_import_one_that_was_named_before_it(tmp_path, forget_own_code):
    (tmp_path / "shared_constant.py").write_text("VALUE = 3.0\n")
    (tmp_path / "dependent.py").write_text("from shared_constant import VALUE\n")
    use_all([tmp_path / "shared_constant.py", tmp_path / "dependent.py"])
    assert sys.modules["dependent"].VALUE == 3.0


@pytest.mark.parametrize("name", ["antigravity", "pip.__main__", "seatsim.__main__"])
def test_a_module_that_does_something_when_it_is_imported_is_refused(name):
    with pytest.raises(seatsim.InputError, match="is part of Python or a program"):
        import_named(name)


@pytest.mark.parametrize("name", ["nowhere", "", ".relative", "a b", "seatsim.nothing", "../powerlaw"])
def test_a_module_that_is_not_there(name):
    with pytest.raises(MissingModuleError, match="no module"):
        import_named(name)
