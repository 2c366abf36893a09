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
    return (
        make_environment()
        .get_template("report.html")
        .render(
            report=report,
            sections=[section for section in report.sections if section.blocks],
            policy=f"default-src 'none'; script-src {_digest(SCRIPTS)}; style-src {_digest(STYLES)}",
        )
    )


def write_html(report: Report, path: Path) -> Path:
    """Write a report as one self-contained HTML file, whole or not at all; return its path.

    Raises:
        InputError: the folder or the file cannot be written.
    """
    return write_text(path, render_report(report))


@lru_cache(maxsize=1)
def make_environment() -> jinja2.Environment:
    """Return the templates, which escape every value; only the scripts and styles of this package pass as they are."""
    found = jinja2.Environment(
        loader=jinja2.PackageLoader("seatsim.report"), autoescape=True, undefined=jinja2.StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    found.globals.update(script=Markup(_read(SCRIPTS)), style=Markup(_read(STYLES)))
    return found


@lru_cache(maxsize=4)
def _read(names: tuple[str, ...]) -> str:
    folder = files(__package__).joinpath("assets")
    return "\n".join(folder.joinpath(name).read_text(encoding="utf-8").strip() for name in names)


def _digest(names: tuple[str, ...]) -> str:
    """Return the source by which a content policy knows a script or a style: nothing else runs on the page."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(_read(names).encode()).digest()).decode()}'"
