"""What reports say: numbers and names as they are printed, how figures are made, what an effect means to an owner."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

from seatsim.diagnosis.result import Cause, Estimate
from seatsim.plots.labels import MINUS, UNKNOWN, describe_channel, format_number, format_percent
from seatsim.report.blocks import Text
from seatsim.schema import registry
from seatsim.schema.errors import InputError
from seatsim.schema.fields import validated
from seatsim.schema.yaml_text import parse_value


def format_quantity(value: float, unit: str) -> str:
    """Return a value in SI units with the unit in which it is shown, as in `12.4 mm`."""
    shown = describe_channel("", unit)
    text = format_number(shown.factor * value)
    return text if shown.unit == "-" or text == UNKNOWN else f"{text} {shown.unit}"


def scale_row(channel: str, unit: str, figures: Iterable[float]) -> list[object]:
    """Return the row of a table: a channel in words, the unit shown, and figures, given in SI units, in that."""
    shown = describe_channel(channel, unit)
    return [shown.words, shown.unit, *(shown.factor * figure for figure in figures)]


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


class _EffectWords(NamedTuple):
    """A clause on what is the matter, `{}` being the size of the parameter named, and what to do about it."""

    clause: str
    action: str
    parameter: str = ""


class Words(NamedTuple):
    """The content of `assets/words.yaml`.

    By kind of report the headings of its sections and sentences on its method; paragraphs that explain figures;
    captions of the tables of a bench sheet, in their order; conditions of each level of credibility; name and
    explanation of each verdict; words for each effect.
    """

    headings: Mapping[str, Mapping[str, str]]
    methods: Mapping[str, Sequence[str]]
    explanations: Mapping[str, Sequence[str]]
    captions: Mapping[str, str]
    conditions: Mapping[str, Sequence[str]]
    verdicts: Mapping[str, tuple[str, str]]
    effects: Mapping[str, _EffectWords]


@lru_cache(maxsize=1)
def read_words() -> Words:
    """Return the words of all reports."""
    return validated(Words, parse_value(files(__package__).joinpath("assets/words.yaml").read_text(encoding="utf-8")))


def explain(name: str, **facts: str) -> list[Text]:
    """Return the paragraphs that explain some figures; `facts` are what they leave open."""
    return [Text(text.format(**facts)) for text in read_words().explanations[name]]


def say_cause(cause: Cause) -> str:
    """Return what is the matter in a clause; of an effect of the reader's own, its documentation."""
    words = read_words().effects.get(cause.effect)
    if words is None:
        return f"{cause.effect} is at work ({describe_effect(cause.effect) or 'an effect of your own'})"
    return words.clause.format(_say_size(cause.parameters, words.parameter), **_say_rest(cause.parameters))


def say_action(effect: str) -> str:
    """Return what to do about an effect."""
    words = read_words().effects.get(effect)
    return words.action if words else format_sentence(f"look at what {effect} describes on the rig")


def _say_size(parameters: Mapping[str, Estimate | str], name: str) -> str:
    found = parameters.get(name)
    if not isinstance(found, Estimate):
        return "some amount"
    if found.unit == "s":
        return f"{format_quantity(abs(1e3 * found.value), '-')} ms"
    return format_quantity(abs(found.value), found.unit)


def _say_rest(parameters: Mapping[str, Estimate | str]) -> dict[str, str]:
    channel, shift = parameters.get("channel"), parameters.get("shift")
    ahead = isinstance(shift, Estimate) and shift.value < 0
    name = channel.replace("_", " ") if isinstance(channel, str) else "of one sensor"
    return {"channel": name, "side": "early" if ahead else "late"}
