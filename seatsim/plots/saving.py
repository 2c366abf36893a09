"""Figures as files, by the ending of the file, and as SVG inside a page of HTML."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from seatsim.plots.style import WIDTH, measure_head

DPI = 180
"""Dots per inch of a PNG: 1044 over the width of a page."""
_COMPRESSION = 3
"""Level of zlib in a PNG, 0 to 9: fast rather than small."""
_NO_DATE: dict[str, str | None] = {"Creator": "seatsim", "Date": None}
OPTIONS: dict[str, dict[str, Any]] = {
    # The stated software takes the place of matplotlib's own entry, which holds its version.
    ".png": {"dpi": DPI, "metadata": {"Software": "seatsim"}, "pil_kwargs": {"compress_level": _COMPRESSION}},
    ".svg": {"metadata": _NO_DATE},
    ".pdf": {"metadata": {"Creator": "seatsim", "Producer": "seatsim", "CreationDate": None}},
}
"""What each ending of a file needs so that the same figure gives the same bytes."""
_SHORTER = (
    (r"(?s)^.*?(?=<svg)|<metadata>.*?</metadata>|\s*\n\s*", " "),
    (r' id="[\w.]+_\d+"| transform="rotate\(-0 [^"]*"', ""),
)
_SHORTER_TAGS = (
    (r"(\.\d)\d{2,}", r"\1"),
    (r"(px|font-family:)[^;:\"]*sans-serif", r"\1 sans-serif"),
    (r"([:;]) ", r"\1"),
)
"""What is left out of an SVG of matplotlib: all beside the drawing, names; in tags digits, certain fonts, spaces."""
_TAG = re.compile("<[^>]*>")


class Inline(NamedTuple):
    """A picture for a page of HTML: the texts that stand beside it, and its address, which holds the drawing."""

    title: str
    note: str
    source: str


def save_figure(figure: Figure, path: Path) -> None:
    """Save a figure to a file, in the format of its ending, one of `OPTIONS`; equal figures give equal bytes."""
    with rc_context({"svg.hashsalt": "seatsim"} if path.suffix == ".svg" else {}):
        figure.savefig(path, **OPTIONS[path.suffix])


def render_inline(figure: Figure) -> Inline:
    """Return a figure for a page of HTML, without title and note, which the page prints; the figure stays as it is.

    It is an SVG on no paper, for a light page; a dark one turns its light and dark around.
    """
    texts = figure.texts
    head = measure_head(*(len(text.get_text().splitlines()) for text in texts)) - 0.04
    file = io.StringIO()
    for text in texts:
        text.set_visible(False)
    with rc_context({"svg.hashsalt": "seatsim", "svg.fonttype": "none", "path.simplify_threshold": 0.3}):
        part = Bbox.from_extents(0.0, 0.0, WIDTH, float(figure.get_figheight()) - head)
        figure.savefig(file, format="svg", metadata=_NO_DATE, transparent=True, dpi=110, bbox_inches=part)
    for text in texts:
        text.set_visible(True)
    drawing = _shorten(file.getvalue(), _SHORTER)
    drawing = _TAG.sub(lambda tag: _shorten(tag[0], _SHORTER_TAGS), drawing)
    source = f"data:image/svg+xml,{quote(drawing.strip(), safe=' /:=;,()-')}"
    words = [text.get_text().replace("\n", " ").replace(r"\$", "$") for text in texts]
    return Inline(words[0], words[1], source)


def _shorten(text: str, patterns: Iterable[tuple[str, str]]) -> str:
    for pattern, shorter in patterns:
        text = re.sub(pattern, shorter, text)
    return text
