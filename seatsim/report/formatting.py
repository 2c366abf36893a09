"""Numbers and names as the report prints them."""

from __future__ import annotations

import inspect
import math
import re

from seatsim.diagnosis.result import Estimate
from seatsim.plots.labels import MINUS, UNKNOWN, describe_channel, format_number, format_percent
from seatsim.schema import registry
from seatsim.schema.errors import InputError


def format_quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return a value in SI units with the unit in which it is shown, as in `12.4 mm`."""
    shown = describe_channel("", unit)
    text = format_number(shown.factor * value, digits)
    return text if shown.unit == "-" or text == UNKNOWN else f"{text} {shown.unit}"


def format_noise(share: float | None) -> str:
    """Return the gap that the stated noise alone makes; one of 0 is that of sensors whose noise nobody stated."""
    return "not stated" if share == 0 else format_percent(share)


def say_noise(share: float) -> str:
    """Return the same as a clause."""
    return "no sensor noise is stated" if share == 0 else f"sensor noise alone makes {format_percent(share)}"


def format_setting(value: float) -> str:
    """Return a number that somebody chose, with no more digits than it has."""
    return f"{value:.6g}".replace("-", MINUS)


def format_estimate(value: Estimate | str) -> str:
    """Return a parameter with its standard deviation, rounded to two digits of that, its unit, and whether it ends."""
    if isinstance(value, str):
        return value
    if value.at_bound:
        return f"{format_estimate(value._replace(at_bound=False))} (the end of its range)"
    shown = describe_channel("", value.unit)
    unit = "" if shown.unit == "-" else f" {shown.unit}"
    value = value._replace(value=shown.factor * value.value, std=shown.factor * value.std)
    if not math.isfinite(value.std) or value.std <= 0:
        return f"{format_number(value.value, 4)}{unit}"
    decimals = max(0, 1 - math.floor(math.log10(value.std)))
    # With more than seven decimals, leading zeros would hide the significant digits.
    if decimals > 7:
        return f"{format_number(value.value, 4)} ± {format_number(value.std, 2)}{unit}"
    return f"{value.value:.{decimals}f} ± {value.std:.{decimals}f}{unit}".replace("-", MINUS)


def format_sentence(text: str) -> str:
    """Return a text with a capital letter in front, a full stop behind and units as printed; names stay as they are."""
    text = re.sub(r"\bdegC\b", "°C", text.strip()).replace("^2", "²")
    text = re.sub(r"(?<=\d)%", " %", text)
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
