"""The page on the architecture draws the layers that the import contracts hold, and names what exists."""

import ast
import re
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CONTRACTS = {contract["name"]: contract for contract in PROJECT["tool"]["importlinter"]["contracts"]}
DIAGRAMS = dict(re.findall(r"<!-- contract: (.+?) -->\n```text\n(.*?)```", PAGE, re.DOTALL))
HOUSE = "values flow one way through the house"
FURTHER = {"cvxpy", "yaml", "pydantic_core", "annotated_types", "llvmlite"}
"""What dependencies of the core install under another name, or with them."""
ENTRY_POINTS = "seatsim.plugins"
DOTTED = re.compile(r"`((?:seatsim|controllers)(?:\.\w+)+)[`(]")
# The changelog names what was, too.
PAGES = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
NAMES = sorted({name for page in PAGES for name in DOTTED.findall(page.read_text(encoding="utf-8"))} - {ENTRY_POINTS})
PATHS = sorted(set(re.findall(r"`((?:seatsim|controllers|benchmarks|tests|docs)/[\w/.]+)`", PAGE)))


def layers_of(name):
    """Return the layers of a contract from the top, each as the names of its members without the container."""
    containers = CONTRACTS[name].get("containers", ["seatsim"])
    return [
        [member.strip().removeprefix(f"{containers[0]}.") for member in layer.split("|")]
        for layer in CONTRACTS[name]["layers"]
    ]


def drawn(name):
    """Return the layers of a diagram; each line is the members, two spaces at least, and a sentence on them."""
    lines = [re.split(r" {2,}", line, maxsplit=1) for line in DIAGRAMS[name].splitlines()]
    assert all(len(line) == 2 and line[1] for line in lines), "a layer has no sentence"
    return [[member.strip() for member in line[0].split(" | ")] for line in lines]


def inside(container):
    """Return the names of the contracts that layer the inside of a package, or of one within it."""
    return [
        name for name, each in CONTRACTS.items() for held in each.get("containers", ()) if held.startswith(container)
    ]


@pytest.mark.parametrize("name", DIAGRAMS)
def test_a_diagram_is_its_contract(name):
    assert drawn(name) == layers_of(name)


def test_the_house_and_every_contract_of_the_diagnosis_are_drawn():
    assert {HOUSE, *inside("seatsim.diagnosis")} <= set(DIAGRAMS)
    assert len(inside("seatsim.diagnosis")) >= 3


def test_every_package_stands_in_the_diagram():
    there = {path.parent.name for path in (ROOT / "seatsim").glob("*/__init__.py")}
    there |= {path.stem for path in (ROOT / "seatsim").glob("*.py")} - {"__init__"}
    assert {member.partition(".")[0] for layer in drawn(HOUSE) for member in layer} == there


def test_modules_begin_with_what_the_core_installs():
    """Libraries of an extra are imported where they are used: without them everything else runs."""
    core = {re.match(r"[\w.-]+", each)[0] for each in PROJECT["project"]["dependencies"]} | FURTHER
    others = {
        (name, path.relative_to(ROOT).parts[1])
        for package in ("seatsim", "controllers")
        for path in (ROOT / package).rglob("*.py")
        for name in imported_first(ast.parse(path.read_text(encoding="utf-8")).body)
        if name not in {*sys.stdlib_module_names, *core, "seatsim", "controllers"}
    }
    assert others == {("pytest", "pytest_plugin.py"), ("starlette", "page"), ("uvicorn", "page")}


def imported_first(nodes):
    """Yield the packages that a module imports when it is loaded, outside functions."""
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from [node.module.partition(".")[0]] * (node.level == 0)
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            yield from imported_first(node.orelse)
        elif not isinstance(node, ast.FunctionDef):
            yield from imported_first(ast.iter_child_nodes(node))


@pytest.mark.parametrize("name", NAMES)
def test_what_is_named_exists(name):
    """A name is a module, or something in one, or a method or field of a class in one."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        if is_module(parts[:end]):
            found = import_module(".".join(parts[:end]))
            break
    for part in parts[end:]:
        assert hasattr(found, part), f"{name}: no '{part}' in {found}"
        found = getattr(found, part)


def is_module(parts):
    """Whether a module or package of this dotted name lies in the repository."""
    path = ROOT.joinpath(*parts)
    return path.with_suffix(".py").is_file() or (path / "__init__.py").is_file()


@pytest.mark.parametrize("path", PATHS)
def test_paths_exist(path):
    assert (ROOT / path).exists()
