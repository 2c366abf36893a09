"""Numbers and names as the report prints them."""

from __future__ import annotations

import inspect
import json
import math
import re

from seatsim.diagnosis.result import Estimate
from seatsim.plots import labels
from seatsim.schema import registry
from seatsim.schema.errors import InputError

UNKNOWN = "–"
"""Printed in place of a value that is not known."""


def format_percent(share: float | None) -> str:
    """Return a share (1 is all) in per cent with two significant digits or more."""
    if share is None or not math.isfinite(share):
        return UNKNOWN
    value = 100.0 * share
    return f"{value:.0f} %" if abs(value) >= 9.95 or value == 0 else f"{value:.1f} %"


def format_estimate(value: Estimate | str) -> str:
    """Return a parameter with its standard deviation, rounded to two digits of that, and its unit."""
    if isinstance(value, str):
        return value
    unit = "" if value.unit in ("", "-") else f" {labels.format_unit(value.unit)}"
    if not math.isfinite(value.std) or value.std <= 0:
        return f"{value.value:.4g}{unit}"
    decimals = max(0, 1 - math.floor(math.log10(value.std)))
    # With more than seven decimals, leading zeros would hide the significant digits.
    if decimals > 7:
        return f"{value.value:.4g} ± {value.std:.2g}{unit}"
    return f"{value.value:.{decimals}f} ± {value.std:.{decimals}f}{unit}"


def format_sentence(text: str) -> str:
    """Return a text with a capital letter in front, a full stop behind and units as printed; names stay as they are."""
    text = re.sub(r"\bdegC\b", "°C", text.strip()).replace("^2", "²")
    if not text:
        return ""
    # A first word such as `damper.remanence` is a name and keeps its small letter.
    first = text.split()[0]
    start = text if re.search(r"[._\d]", first.rstrip(".,:;")) else text[0].upper() + text[1:]
    return start if start[-1] in ".!?" else f"{start}."


def describe_effect(effect: str) -> str:
    """Return what an effect is, from the first words of its documentation; empty where it is not registered."""
    try:
        text = inspect.getdoc(registry.find("effect", effect)) or ""
    except InputError:
        return ""
    return re.split(r"[.:;](?:\s|$)", text, maxsplit=1)[0].replace("`", "").strip()


def format_value(value: object) -> str:
    """Return any value of a proposed experiment as text."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list | tuple) and all(isinstance(item, str) for item in value):
        return ", ".join(value)
    return json.dumps(value, ensure_ascii=False, default=str)
