"""Settings of the documentation site: `sphinx-build -W --keep-going docs out/site`."""

from __future__ import annotations

import inspect
import re
from importlib.metadata import version as version_of
from pathlib import Path

from docutils.nodes import SkipNode, math, math_block
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer
from sphinx.util.logging import getLogger
from sphinx.writers.html5 import HTML5Translator

logger = getLogger(__name__)

project = "seatsim"
author = "the seatsim project"
version = release = version_of("seatsim")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["schemas", "sweeps", "yu2019", "images"]
nitpicky = True
# Types of signatures are shown, not linked: most are of libraries whose pages a build does not fetch.
nitpick_ignore_regex = [("py:.*", ".*")]
nb_execution_mode = "off"
autodoc_preserve_defaults = True

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


def write_docstring_as_text(
    app: Sphinx, kind: str, name: str, value: object, options: object, lines: list[str]
) -> None:
    """Let a docstring be read as plain text: names in code, indented equations as they stand."""
    text = re.sub(r"`([^`\n]+)`", r"``\1``", "\n".join(lines))
    text = re.sub(r"(``.*?``)|([|*\\])", lambda found: found[1] or "\\" + found[2], text)
    lines[:] = re.sub(r"(?m)(?<=\S)\n\n(?= {4}(?!:))", "\n\n::\n\n", text).split("\n")


def skip_plain_field(app: Sphinx, kind: str, name: str, value: object, skip: bool, options: object) -> bool | None:
    """Leave out fields of named tuples without a text of their own: their types stand in the signature."""
    if not (value.__doc__ or "").startswith("Alias for field number"):
        return None
    described = ModuleAnalyzer.for_module(app.env.temp_data["autodoc:module"]).find_attr_docs()
    return None if any(field == name for _, field in described) else True


def name_fields(app: Sphinx, kind: str, name: str, value: type, *_: object) -> tuple[str, None] | None:
    """Show of a class the names and defaults of its fields; their types are long, and stand in its docstring."""
    if kind != "class":
        return None
    fields = inspect.signature(value).parameters.values()
    return f"({', '.join(str(field.replace(annotation=field.empty)) for field in fields)})", None


def write_llms_file(app: Sphinx, error: Exception | None) -> None:
    """Write `llms.txt`, for programs that read: title, address and first sentence of each page."""
    if error or app.builder.format != "html":
        return
    lines = [f"# {project} {version}", ""]
    for page in sorted(app.env.found_docs):
        source = Path(app.env.doc2path(page)).read_text(encoding="utf-8")
        paragraph = re.search(r"^(?=[A-Z`])(?!```).+?(?=\n\n|\Z)", source, re.DOTALL | re.MULTILINE)
        words = re.sub(r"\[(.+?)\]\(.+?\)", r"\1", " ".join(paragraph[0].split())) if paragraph else ""
        sentence = re.split(r"(?<=\.) (?=[A-Z`])", words)[0]
        lines.append(f"- [{app.env.titles[page].astext()}]({page}.html): {sentence}".rstrip(": "))
    (Path(app.outdir) / "llms.txt").write_text("\n".join([*lines, ""]), encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Register what the site needs beyond its settings."""
    app.add_html_math_renderer("mathml", (write_formula, None), (write_formula, None))
    app.connect("source-read", lead_to_page)
    # Before the extension that reads the sections of a docstring.
    app.connect("autodoc-process-docstring", write_docstring_as_text, priority=400)
    app.connect("autodoc-skip-member", skip_plain_field)
    app.connect("autodoc-process-signature", name_fields)
    app.connect("build-finished", write_llms_file)
