"""Figures as files, by the ending of the file, and as SVG inside a page of HTML."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from matplotlib import rc_context
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from seatsim.plots.style import WIDTH, measure_head

DPI = 180
"""Dots per inch of a PNG: 1044 over the width of a page."""
_COMPRESSION = 3
"""Level of zlib in a PNG, 0 to 9: fast rather than small."""
_NO_DATE: dict[str, Any] = {"Creator": "seatsim", "Date": None}
OPTIONS: dict[str, dict[str, Any]] = {
    # The stated software takes the place of matplotlib's own entry, which holds its version.
    ".png": {"dpi": DPI, "metadata": {"Software": "seatsim"}, "pil_kwargs": {"compress_level": _COMPRESSION}},
    ".svg": {"metadata": _NO_DATE},
    ".pdf": {"metadata": {"Creator": "seatsim", "Producer": "seatsim", "CreationDate": None}},
}
"""What each ending of a file needs so that the same figure gives the same bytes."""
_INLINE: dict[Any, Any] = {"svg.hashsalt": "seatsim", "svg.fonttype": "none", "path.simplify_threshold": 0.3}
_NAMESPACE = re.compile(r"\{.*?\}")
_DROPPED = {"font-family", "stroke-linejoin", "stroke-miterlimit", "image-rendering"}
"""Properties that a page sets for all pictures, or that hardly show."""
POINTS = 72
"""Units of an SVG in an inch."""


class Inline(NamedTuple):
    """A picture for a page of HTML: the texts that stand beside it, and its drawing as an element `svg`."""

    title: str
    note: str
    svg: str


def save_figure(figure: Figure, path: Path) -> None:
    """Save a figure to a file, in the format of its ending, one of `OPTIONS`; equal figures give equal bytes."""
    with rc_context({"svg.hashsalt": "seatsim"} if path.suffix == ".svg" else {}):
        figure.savefig(path, **OPTIONS[path.suffix])


def render_inline(figure: Figure, name: str) -> Inline:
    """Return a figure for a page of HTML, as wide as its place there, in the colours of the page.

    Greys are mixed of the page's `--ink` and `--paper`, other colours with white as far as `--keep` says: so the
    picture is right on light and dark paper. Title and note of the figure are taken out of the drawing. Styles are
    attributes, since a content policy forbids those of elements.

    Args:
        figure: of `make_page`; it stays as it is.
        name: of the picture, which sets its identifiers apart from those of others on the page.
    """
    texts = figure.texts
    title, note = (text.get_text() for text in texts)
    file = io.StringIO()
    with rc_context(_INLINE):
        for text in texts:
            text.set_visible(False)
        figure.savefig(file, format="svg", metadata=_NO_DATE, transparent=True, dpi=110)
        for text in texts:
            text.set_visible(True)
    head = measure_head(*(len(text.splitlines()) for text in (title, note))) - 0.04
    title, note = (" ".join(text.splitlines()).replace(r"\$", "$") for text in (title, note))
    root = ElementTree.fromstring(file.getvalue())  # noqa: S314  # matplotlib wrote it a moment ago
    width, height = POINTS * WIDTH, POINTS * float(figure.get_figheight())
    root.attrib = {
        "viewBox": f"0 {POINTS * head:.1f} {width:.1f} {height - POINTS * head:.1f}", "role": "img",
        "aria-label": f"{title}. {note}".removesuffix(" "),
    }  # fmt: skip
    _restyle(root, name)
    return Inline(title, note, ElementTree.tostring(root, encoding="unicode"))


def _restyle(root: ElementTree.Element, name: str) -> None:
    """Write an SVG of matplotlib anew: short names, attributes instead of styles, the page's colours, few digits."""
    used = set(re.findall(r"#([\w-]+)", " ".join(value for each in root.iter() for value in each.attrib.values())))
    for each in root.iter():
        each.tag = _NAMESPACE.sub("", each.tag)
        for child in [child for child in each if child.tag.endswith(("metadata", "style"))]:
            each.remove(child)
        given = {_NAMESPACE.sub("", key): value for key, value in each.attrib.items()}
        style = (part.split(":", 1) for part in given.pop("style", "").split(";") if part.strip())
        given |= {key.strip(): value.strip() for key, value in style if key.strip() not in _DROPPED}
        if given.get("id") not in used:
            given.pop("id", None)
        each.attrib = {key: _adapt(key, value, name) for key, value in given.items()}
        each.tail = None


def _adapt(key: str, value: str, name: str) -> str:
    if key in ("d", "points", "x", "y", "width", "height"):
        return re.sub(r"-?\d+\.\d{2,}", lambda number: f"{float(number[0]):.1f}".replace(".0", ""), value).strip()
    if key in ("fill", "stroke") and value.startswith("#"):
        red, green, blue = to_rgb(value)
        if red == green == blue:
            return f"color-mix(in srgb, var(--ink) {100 * (1 - red):.0f}%, var(--paper))"
        return f"color-mix(in oklab, {value} var(--keep), #fff)"
    if key == "id":
        return f"{name}-{value}"
    return value.replace("url(#", f"url(#{name}-") if value.startswith("url(#") else (
        f"#{name}-{value[1:]}" if key == "href" and value.startswith("#") else value
    )  # fmt: skip
