"""Equations of docstrings become LaTeX."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "reference").glob("dampers_*.md")), ids=lambda page: page.stem)
def test_every_equation_is_balanced(page):
    for block in re.findall(r"```math\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        bare = block.replace(r"\{", "").replace(r"\}", "")
        assert bare.count("{") == bare.count("}"), block
        assert re.search(r"(?<![\\\w])(alpha|exp|tanh)\b", bare) is None, block
