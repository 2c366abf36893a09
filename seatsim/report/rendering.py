"""A report as one HTML file that asks for nothing from outside."""

from __future__ import annotations

import base64
import hashlib
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

import jinja2
from markupsafe import Markup

from seatsim.report.blocks import Report
from seatsim.schema.files import write_text

SCRIPTS = ("uPlot.iife.min.js", "charts.js")
STYLES = ("uPlot.min.css", "report.css")


def render_report(report: Report) -> str:
    """Return a report as HTML; the same report gives the same text. Every text is escaped by the template."""
    script, style = read_asset(SCRIPTS), read_asset(STYLES)
    sections = [section for section in report.sections if section.blocks]
    policy = f"default-src 'none'; script-src {digest_of(script)}; img-src data:; style-src {digest_of(style)}"
    facts = {"report": report, "sections": sections, "policy": policy}
    return make_environment().get_template("report.html").render(facts, script=Markup(script), style=Markup(style))


def write_html(report: Report, path: Path) -> Path:
    """Write a report as one self-contained HTML file, whole or not at all; return its path.

    Raises:
        InputError: the folder or the file cannot be written.
    """
    return write_text(path, render_report(report))


@lru_cache(maxsize=1)
def make_environment() -> jinja2.Environment:
    """Return the templates, which escape every value that is not marked as safe; nothing from a file ever is."""
    return jinja2.Environment(
        loader=jinja2.PackageLoader("seatsim.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


@lru_cache(maxsize=8)
def read_asset(names: tuple[str, ...]) -> str:
    """Return some scripts or styles of this package as one text."""
    folder = files(__package__).joinpath("assets")
    return "\n".join(folder.joinpath(name).read_text(encoding="utf-8").strip() for name in names)


def digest_of(text: str) -> str:
    """Return the source by which a content policy knows a script or a style: nothing else runs on the page."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
