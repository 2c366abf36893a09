"""The names of the nomenclature are those of the code."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "nomenclature.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if re.match(r"\|(?!---)", line)
]
HEADINGS = ["symbol", "name in the code", "unit", "meaning", "source"]
ENTRIES = [row for row in ROWS if row != HEADINGS]


def read_names(path):
    """Yield the names of a file, the texts that are its keys, and `Class.member` for what its classes hold."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        yield from (word for word in vars(node).values() if isinstance(word, str))
        for each in node.body if isinstance(node, ast.ClassDef) else ():
            name = each.target.id if isinstance(each, ast.AnnAssign) else getattr(each, "name", "")
            yield f"{node.name}.{name}"


def test_every_row_has_a_meaning_and_names_of_the_code_that_stand_for_nothing_else():
    assert len(ENTRIES) > 40
    files = [path for package in ("seatsim", "controllers") for path in (ROOT / package).rglob("*.py")]
    code, names = {name for path in files for name in read_names(path)}, []
    for row in ENTRIES:
        assert len(row) == len(HEADINGS) and row[3], row
        found = re.findall(r"`([\w.]+)`", row[1])
        assert found and code >= set(found), row
        names += found
    assert len(names) == len(set(names))
