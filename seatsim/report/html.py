"""HTML built from values: whatever is not markup already is escaped."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence

from seatsim.plots.frame import Picture, render_png

EMPTY_TAGS = ("img", "meta", "br")
CSS_DPI = 96
"""CSS pixels per inch."""
WIDE_FROM = 600
"""CSS pixels from which on a picture takes the width of the page."""


class Html(str):
    """Text that is markup and needs no escaping."""

    __slots__ = ()


def tag(name: str, *children: str, **attributes: str) -> Html:
    """Return an element; `class_` is the attribute class, `aria_label` is aria-label, empty attributes are left out."""
    inner = "".join(_escape(child) for child in children)
    written = {key.rstrip("_").replace("_", "-"): html.escape(value) for key, value in attributes.items() if value}
    given = "".join(f' {key}="{value}"' for key, value in written.items())
    return Html(f"<{name}{given}>" if name in EMPTY_TAGS else f"<{name}{given}>{inner}</{name}>")


def join(parts: Iterable[str], between: str = "") -> Html:
    """Return parts one after the other."""
    return Html(_escape(between).join(_escape(part) for part in parts))


def make_table(head: Sequence[str], rows: Iterable[Sequence[str]], words: int = 1, strong: Sequence[int] = ()) -> Html:
    """Return a table: the first columns hold `words`, the others numbers; rows in `strong` stand out."""
    lines = [
        tag(
            "tr", *(_make_cell(text, column, words) for column, text in enumerate(row)), class_="strong" * (k in strong)
        )
        for k, row in enumerate(rows)
    ]
    titles = [tag("th", text, scope="col", class_="number" * (k >= words)) for k, text in enumerate(head)]
    body = tag("table", tag("thead", tag("tr", *titles)), tag("tbody", *lines))
    return tag("div", body, class_="scroll")


def make_list(items: Iterable[str]) -> Html:
    """Return a list; nothing where there are no items."""
    lines = [tag("li", item) for item in items]
    return tag("ul", *lines) if lines else Html("")


def embed_pictures(found: Iterable[Picture | None]) -> Html:
    """Return pictures that stand beside each other where there is room; nothing where there are none."""
    shown = [_embed_picture(picture) for picture in found if picture is not None]
    return tag("div", *shown, class_="pictures") if shown else Html("")


def _embed_picture(picture: Picture) -> Html:
    image = render_png(picture.figure)
    wide, high = (f"{CSS_DPI * size:.0f}" for size in picture.figure.get_size_inches())
    source = "data:image/png;base64," + base64.b64encode(image).decode("ascii")
    drawn = tag("img", src=source, alt=f"{picture.title}. {picture.caption}", width=wide, height=high)
    caption = tag("p", picture.caption, class_="caption")
    return tag("figure", tag("h3", picture.title), drawn, caption, class_="wide" * (float(wide) > WIDE_FROM))


def _make_cell(text: str, column: int, words: int) -> Html:
    if column == 0:
        return tag("th", text, scope="row")
    return tag("td", text, class_="number" * (column >= words))


def _escape(text: str) -> str:
    """Return text as markup; names come from recordings of strangers, so that only `Html` passes as it is."""
    return text if isinstance(text, Html) else html.escape(text)
