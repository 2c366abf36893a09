"""The report of a diagnosis: one HTML file that needs no network, with the answer first and then the evidence.

This package builds the page only. `seatsim.plots.diagnosis` draws its figures; its numbers come from the diagnosis.
"""

from __future__ import annotations

from pathlib import Path

from seatsim.diagnosis.result import Diagnosis
from seatsim.report.page import render_page
from seatsim.schema.files import write_text

__all__ = ["write_report"]


def write_report(diagnosis: Diagnosis, path: Path) -> Path:
    """Write the report of a diagnosis as one self-contained HTML file, complete or not at all; return its path.

    The same diagnosis gives the same bytes. Sections without content are left out.

    Raises:
        InputError: the folder or the file cannot be written.
    """
    return write_text(path, render_page(diagnosis))
