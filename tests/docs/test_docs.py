"""The documentation says what the code does."""

import inspect
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from seatsim.cli.app import app
from seatsim.diagnosis.settings import DiagnosisSettings

from ..text import words

ROOT = Path(__file__).resolve().parents[2]
BENCH = tuple(
    words("""
    --model --parameters --currents --temperatures --amplitudes --frequencies --test --test-fraction --fix
    --ignore-temperature --predict --moving-average --centred
""")
)
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


def test_built_pages_are_up_to_date():
    # In a process of its own: other tests register models that are none of the package's.
    code = "import build_reference as built, json, sys; json.dump(built.pages(), sys.stdout)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT / "docs", capture_output=True, encoding="utf-8", check=True
    )
    for file, text in json.loads(done.stdout).items():
        assert (ROOT / "docs" / file).read_text(encoding="utf-8") == text, "run python docs/build_reference.py"


def test_every_setting_of_a_diagnosis_says_how_it_was_chosen():
    """The page of settings consists of these texts; a field without one would be missing there in silence."""
    page = (ROOT / "docs" / "settings.md").read_text(encoding="utf-8")
    for settings in DiagnosisSettings():
        cls = type(settings)
        assert f".. automodule:: {cls.__module__}\n" in page
        texts = re.findall(r'^    (\w+): [^\n]+\n    """(.+?)"""', inspect.getsource(cls), re.MULTILINE | re.DOTALL)
        assert [field for field, _ in texts] == list(settings._fields)
        assert all("Chosen: " in text for _, text in texts)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_every_command_and_option_has_an_example():
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    examples = "\n".join(re.findall(r"```sh\n(.*?)```", text, re.DOTALL))
    for command in app.registered_commands:
        assert f"seatsim {command.name or command.callback.__name__.replace('_', '-')} " in examples
    for command in ("make", "score"):
        assert f"seatsim blind {command} " in examples
    for option in (
        "--out",
        "--set",
        "--without",
        "--cases",
        "--seed",
        "--sealed",
        "--kinds",
        "--carrier",
        "--key",
        "--bracket",
        "--with",
        "--map",
        "--nominal",
        "--json",
        "--picture",
        "--engine",
        "--address",
        "--jobs",
        "--resume",
        "--keep",
        "--part",
        "--slurm",
        "--version",
        "--show-completion",
        *BENCH,
    ):
        assert option in examples


# In a process of its own, where what the examples register stays.
CODE = """
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from seatsim import load, load_recording, use
from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.problem import pose_problem
from seatsim.effects.base import off
from seatsim.kernel.rig import Disturbance, Rig, derivative
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import TemperatureScaling

use("power_law.py")
use("fast_strokes.py")
AirDrag = use("bellows.py").AirDrag

effects = [{"effect": "bellows:AirDrag", "parameters": {"drag": 350.0}}]
scenario, = load("quickstart", {"effects": effects, "variants": {}, "sweep": {}})
assert scenario.effects == (AirDrag(350.0),)


def rates(*effects):
    rig = Rig(scenario.plant, scenario.damper.record, effects)
    state = (0.0, 0.3) + (0.0,) * (MECHANICAL - 2) + (0.0,)
    return derivative(rig, state, Disturbance(0.0, 0.0, 0.0), 0.5, TemperatureScaling(), 0.0)[0]


change = rates(*scenario.effects)[1] - rates()[1]
assert np.isclose(change, -350.0 * 0.3**2 / scenario.plant.frame_mass)
assert rates(off(AirDrag)) == rates()
with ThreadPoolExecutor() as pool:
    candidates = list_candidates(pose_problem(load_recording(RECORDING), pool))
found = [candidate for candidate in candidates if candidate.cls is AirDrag]
assert [(candidate.effect, candidate.start, candidate.high) for candidate in found] == [
    ("suspension.air_drag", (200.0,), (1e5,))
]
"""


def test_the_examples_of_own_parts_work(tmp_path):
    for page in ("damper", "controller", "effect"):
        text = (ROOT / "docs" / f"howto_{page}.md").read_text(encoding="utf-8")
        ((name, block),) = re.findall(r"^cat > (\w+\.py) <<'PY'\n(.*?)^PY$", text, re.DOTALL | re.MULTILINE)
        (tmp_path / name).write_text(block, encoding="utf-8")
    recording = f"RECORDING = {str(ROOT / 'scenarios' / 'data' / 'recording')!r}"
    done = subprocess.run(
        [sys.executable, "-c", recording + CODE], cwd=tmp_path, capture_output=True, encoding="utf-8", check=False
    )
    assert done.returncode == 0, done.stderr


def test_the_citation_names_this_version():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_how_often_a_diagnosis_is_right_is_stated_on_one_page_only():
    """Each new set of cases would leave another figure behind elsewhere."""
    assert not re.findall(r"\d+ of \d+", (ROOT / "docs" / "limits.md").read_text(encoding="utf-8"))


def test_every_dependency_of_the_core_is_needed_and_says_what_for():
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    names = [re.match(r"[\w.-]+", each)[0] for each in stated]
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = page.partition("| library | for |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| ([\w.-]+) \| \S", table, re.MULTILINE) == names
    files = [path for package in ("seatsim", "controllers") for path in (ROOT / package).rglob("*.py")]
    source = "\n".join(path.read_text(encoding="utf-8") for path in files)
    imported = re.findall(r"^\s*(?:import|from) ([\w.]+)", source, re.MULTILINE)
    for name in names:
        module = {"pyyaml": "yaml"}.get(name, name.replace("-", "_"))
        # A solver of cvxpy is named, not imported.
        assert any(f"{each}.".startswith(f"{module}.") for each in imported) or module.upper() in source, name
