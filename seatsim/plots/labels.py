"""Text of figures: units as they are printed, and names that matplotlib must not interpret."""

from __future__ import annotations

LONGEST = 52
"""Letters of a label; longer ones are cut in the middle, so that its ends stay legible."""
LONGEST_TITLE = 64
"""Letters of a name in a title, which has the width of the page to itself."""
PRETTY = {"degC": "°C", "^1.75": "¹·⁷⁵", "^2": "²", "^3": "³", "ohm": "Ω", " s/m": "·s/m"}
"""What stands in files and in print, in the order in which it is replaced."""


def format_unit(text: str) -> str:
    """Return a unit as it is printed: `N s/m` as `N·s/m`, `m/s^2` as `m/s²`."""
    for written, printed in PRETTY.items():
        text = text.replace(written, printed)
    return text


def clean_text(text: str, longest: int) -> str:
    """Return a text of at most `longest` letters that matplotlib prints as it stands.

    Names come from scenarios and recordings. matplotlib would set what stands between two dollar signs as a formula,
    and hides a label that begins with an underscore.
    """
    half = longest // 2
    short = text if len(text) <= longest else f"{text[: half - 1]}…{text[-half:]}"
    return (f" {short}" if short.startswith("_") else short).replace("$", r"\$")
