"""Settings of the documentation site: `sphinx-build -W --keep-going docs out/site`."""

from __future__ import annotations

from importlib.metadata import version as version_of

from sphinx.application import Sphinx

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


def lead_to_page(app: Sphinx, page: str, source: list[str]) -> None:
    """Let links to files beside this folder lead to the pages that include them."""
    for file, including in (("CONTRIBUTING.md", "contributing.md"), ("CHANGELOG.md", "changes.md")):
        source[0] = source[0].replace(f"](../{file}", f"]({including}")


def setup(app: Sphinx) -> None:
    """Register what the site needs beyond its settings."""
    app.connect("source-read", lead_to_page)
