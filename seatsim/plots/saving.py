"""Figures as files: PNG for screens, SVG and PDF for papers, by the ending of the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

DPI = 110
"""Dots per inch of a PNG: 1100 over the width of a page."""
COMPRESSION = 3
"""Level of zlib in a PNG, 0 to 9: fast rather than small."""
NO_DATE: dict[str, Any] = {"Creator": "seatsim", "Date": None}
OPTIONS: dict[str, dict[str, Any]] = {
    # The stated software takes the place of matplotlib's own entry, which holds its version.
    ".png": {"dpi": DPI, "metadata": {"Software": "seatsim"}, "pil_kwargs": {"compress_level": COMPRESSION}},
    ".svg": {"metadata": NO_DATE},
    ".pdf": {"metadata": {"Creator": "seatsim", "Producer": "seatsim", "CreationDate": None}},
}
"""What each ending of a file needs so that the same figure gives the same bytes."""


def save_figure(figure: Figure, path: Path) -> None:
    """Save a figure to a file, in the format of its ending, one of `OPTIONS`; equal figures give equal bytes."""
    with rc_context({"svg.hashsalt": "seatsim"} if path.suffix == ".svg" else {}):
        figure.savefig(path, **OPTIONS[path.suffix])
