"""Equations of docstrings become LaTeX."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))
from equations import convert, convert_equations  # noqa: E402


@pytest.mark.parametrize(
    ("line", "latex"),
    [
        ("c_a v + f0", r"c_{\mathrm{a}} v + f_{\mathrm{0}}"),
        ("alpha |w|^(n-1)", r"\alpha  |w|^{n-1}"),
        ("sqrt(2 pi) sgn(v)", r"\sqrt{2 \pi } \operatorname{sgn}(v)"),
        ("{v - dG/dp} <= 0", r"\{v - \frac{dG}{dp}\} \le  0"),
    ],
)
def test_an_equation_becomes_latex(line, latex):
    assert convert(line) == latex


def test_equations_on_one_line_become_rows():
    assert convert_equations("F = k e,   e' = v").count("& ") == 2


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "reference").glob("dampers_*.md")), ids=lambda page: page.stem)
def test_every_equation_is_balanced(page):
    for block in re.findall(r"```math\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        bare = block.replace(r"\{", "").replace(r"\}", "")
        assert bare.count("{") == bare.count("}"), block
        assert re.search(r"(?<![\\\w])(alpha|exp|tanh)\b", bare) is None, block
