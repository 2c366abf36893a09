"""The documentation says what the code does."""

import inspect
import json
import re
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from typer.main import get_command

import seatsim
from seatsim.cli.app import app
from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.effects.base import off
from seatsim.kernel.rig import Disturbance, Rig, derivative
from seatsim.rig.state import MECHANICAL
from seatsim.rig.temperature import TemperatureScaling

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))
from run_examples import read_blocks  # noqa: E402

SHARED = {"--json", "--pdf", "--set", "--with"}
"""Options of many commands, of which one example is enough."""
NOT_RUN = {"sweep": {"--engine", "--address"}}
"""Options whose examples would take minutes or a cluster."""
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
BUILT = """
import json, sys
import build_reference, build_schemas
pages = {f"docs/{file}": text for file, text in build_reference.pages().items()}
json.dump(pages | build_schemas.schemas(), sys.stdout)
"""


def test_built_pages_and_schemas_are_up_to_date():
    # In a process of its own: other tests register models that are none of the package's.
    done = subprocess.run([sys.executable, "-c", BUILT], cwd=ROOT / "docs", stdout=subprocess.PIPE, check=True)
    for file, text in json.loads(done.stdout).items():
        assert (ROOT / file).read_text(encoding="utf-8") == text, f"{file}: run docs/build_reference.py or _schemas.py"


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


def options_of(examples):
    """Return the options that shell code gives to each command."""
    found = {}
    for line in examples.replace("\\\n", " ").splitlines():
        for command, rest in re.findall(r"\bseatsim ((?:blind )?[a-z][a-z-]*)(.*)", line):
            found.setdefault(command, set()).update(re.findall(r"(?<=\s)--[a-z-]+", rest))
    return found


def test_every_command_and_option_has_an_example_that_is_run():
    commands = dict(get_command(app).commands)
    commands |= {f"blind {name}": command for name, command in commands.pop("blind").commands.items()}
    known = {name: {word for each in command.params for word in each.opts} for name, command in commands.items()}
    pages = sorted((ROOT / "docs").glob("*.md"))
    blocks = [block.content for page in pages for block in read_blocks(page) if block.language == "sh"]
    run = options_of("\n".join(blocks))
    for name, options in known.items():
        own = {word for word in options if word.startswith("--")} - SHARED
        assert own - NOT_RUN.get(name, set()) <= run[name], name
    assert set.union(*run.values()) >= SHARED - {"--pdf"}
    text = "\n".join(re.findall(r"```sh\n(.*?)```", "".join(page.read_text() for page in pages), re.DOTALL))
    for name, options in options_of(text).items():
        assert options <= known[name] and NOT_RUN.get(name, set()) <= options, name


def test_the_examples_of_own_parts_work(tmp_path, forget_own_code):
    for page in ("damper", "controller", "effect"):
        text = (ROOT / "docs" / f"howto_{page}.md").read_text(encoding="utf-8")
        for name, block in re.findall(r"^cat > (\w+\.py) <<'PY'\n(.*?)^PY$", text, re.DOTALL | re.MULTILINE):
            (tmp_path / name).write_text(block, encoding="utf-8")
            cls = vars(seatsim.use(tmp_path / name))[re.search(r"^class (\w+)", block, re.MULTILINE)[1]]
    effects = [{"effect": "bellows:AirDrag", "parameters": {"drag": 350.0}}]
    (scenario,) = seatsim.load("quickstart", {"effects": effects, "variants": {}, "sweep": {}})
    assert scenario.effects == (cls(350.0),)

    def rates(*effects):
        rig = Rig(scenario.plant, scenario.damper.record, effects)
        state = (0.0, 0.3) + (0.0,) * (MECHANICAL - 2) + (0.0,)
        return derivative(rig, state, Disturbance(0.0, 0.0, 0.0), 0.5, TemperatureScaling(), 0.0)[0]

    change = rates(*scenario.effects)[1] - rates()[1]
    assert change == pytest.approx(-350.0 * 0.3**2 / scenario.plant.frame_mass)
    assert rates(off(cls)) == rates()
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(seatsim.load_recording(ROOT / "scenarios" / "data" / "recording"), pool)
        found = [candidate for candidate in list_candidates(problem) if candidate.cls is cls]
    assert [(each.effect, each.start, each.high) for each in found] == [("suspension.air_drag", (200.0,), (1e5,))]


def test_the_citation_names_this_version():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


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
        module = {"pyyaml": "yaml", "cvxpy-base": "cvxpy"}.get(name, name.replace("-", "_"))
        # A solver of cvxpy is named, not imported.
        assert any(f"{each}.".startswith(f"{module}.") for each in imported) or module.upper() in source, name
