"""Settings of the documentation site: `sphinx-build -W --keep-going docs out/site`."""

from __future__ import annotations

from importlib.metadata import version as version_of

from docutils.nodes import SkipNode, math, math_block
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.logging import getLogger
from sphinx.writers.html5 import HTML5Translator

logger = getLogger(__name__)

project = "seatsim"
author = "the seatsim project"
version = release = version_of("seatsim")

extensions = ["myst_parser", "sphinx_copybutton"]
exclude_patterns = ["schemas", "sweeps", "yu2019", "images"]
nitpicky = True

# Pages are read on GitHub as well: its anchors of headings, and its blocks of mathematics.
myst_enable_extensions = ["amsmath", "dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4

html_theme = "furo"
html_title = f"seatsim {version}"
html_theme_options = {"navigation_with_keys": True}
html_show_copyright = False
# Formulas that are wider than a telephone are moved by themselves, not with the page.
html_static_path = ["static"]
html_css_files = ["wide.css"]
# Browsers draw MathML by themselves: formulas need neither a script nor a network.
html_math_renderer = "mathml"


def write_formula(writer: HTML5Translator, node: math | math_block) -> None:
    """Write a formula as MathML, one on lines of its own in a frame that can be moved sideways."""
    on_own_lines = isinstance(node, math_block)
    try:
        formula = tex2mathml(node.astext(), as_block=on_own_lines)
    except MathError as error:
        logger.warning("formula: %s: %s", error, node.astext(), location=node)
        raise SkipNode from error
    writer.body.append(f'<div class="math">{formula}</div>' if on_own_lines else formula)
    raise SkipNode


def lead_to_page(app: Sphinx, page: str, source: list[str]) -> None:
    """Let links to files beside this folder lead to the pages that include them."""
    for file, including in (("CONTRIBUTING.md", "contributing.md"), ("CHANGELOG.md", "changes.md")):
        source[0] = source[0].replace(f"](../{file}", f"]({including}")


def setup(app: Sphinx) -> None:
    """Register what the site needs beyond its settings."""
    app.add_html_math_renderer("mathml", (write_formula, None), (write_formula, None))
    app.connect("source-read", lead_to_page)
