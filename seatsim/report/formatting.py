"""What reports say: numbers and names as they are printed, how figures are made, what an effect is."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

from seatsim.report.blocks import Rows, Table, Text, tabulate
from seatsim.schema import registry
from seatsim.schema.errors import InputError
from seatsim.schema.fields import validated
from seatsim.schema.printing import MINUS, UNKNOWN, describe_channel, format_number, format_percent
from seatsim.schema.text import join_names
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

    By kind of report the headings of its sections and sentences on its method; paragraphs that explain figures; caption
    and headings of tables; captions of the tables of a bench sheet, in their order; name and explanation of
    each verdict; what to do next, by the fact that asks for it; words for each effect.
    """

    headings: Mapping[str, Mapping[str, str]]
    methods: Mapping[str, Sequence[str]]
    explanations: Mapping[str, Sequence[str]]
    tables: Mapping[str, tuple[str, str]]
    captions: Mapping[str, str]
    verdicts: Mapping[str, tuple[str, str]]
    advice: Mapping[str, str]
    effects: Mapping[str, _EffectWords]


@lru_cache(maxsize=1)
def read_words() -> Words:
    """Return the words of all reports."""
    return validated(Words, parse_value(files(__package__).joinpath("assets/words.yaml").read_text(encoding="utf-8")))


def show_table(
    name: str, rows: Rows, words: int = 1, strong: Sequence[int] = (), folded: bool = False, **facts: str
) -> list[Table]:
    """Return a table as `tabulate` does, with caption and headings of its name; `facts` are what these leave open."""
    caption, head = (text.format(**facts) for text in read_words().tables[name])
    return tabulate(caption, head, rows, words, strong, folded)


def explain(name: str, **facts: str) -> list[Text]:
    """Return the paragraphs that explain some figures; `facts` are what they leave open."""
    return [Text(text.format(**facts)) for text in read_words().explanations[name]]


def choose_advice(**facts: object) -> list[str]:
    """Return what to do next: of each fact that holds the advice of its name, in which names or a number state it."""
    held = {name: join_names(fact) if isinstance(fact, list) else fact for name, fact in facts.items() if fact}
    return [read_words().advice[name].format(fact) for name, fact in held.items()]
