"""The names of the nomenclature are those of the code."""

import ast
import re
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "nomenclature.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if re.match(r"\|(?!---)", line)
]
HEADINGS = ["symbol", "name in the code", "unit", "meaning", "source"]
ENTRIES = [row for row in ROWS if row != HEADINGS]


def read_names(path):
    """Return the names that a file uses, and the words that are its keys, such as those of channels."""
    with tokenize.open(path) as file:
        tokens = list(tokenize.generate_tokens(file.readline))
    names = {token.string for token in tokens if token.type == tokenize.NAME}
    return names | {token.string.strip("\"'") for token in tokens if token.type == tokenize.STRING}


def read_members(path):
    """Return `Class.member` for the fields and methods of a file's classes."""
    members = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        for each in node.body if isinstance(node, ast.ClassDef) else ():
            if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name):
                members.add(f"{node.name}.{each.target.id}")
            elif isinstance(each, ast.FunctionDef):
                members.add(f"{node.name}.{each.name}")
    return members


@pytest.fixture(scope="module")
def code():
    """All names of the product."""
    files = [path for package in ("seatsim", "controllers") for path in (ROOT / package).rglob("*.py")]
    return {name for path in files for read in (read_names, read_members) for name in read(path)}


@pytest.mark.parametrize("row", ENTRIES, ids=lambda row: row[1])
def test_names_occur_in_the_code(row, code):
    names = re.findall(r"`([\w.]+)`", row[1])
    assert names
    for name in names:
        assert name in code, name


def test_every_row_says_what_it_means():
    assert len(ENTRIES) > 80
    for row in ENTRIES:
        assert len(row) == len(HEADINGS), row
        assert row[3], row


def test_no_name_stands_for_two_things():
    names = [name for row in ENTRIES for name in re.findall(r"`([\w.]+)`", row[1])]
    assert len(names) == len(set(names))
