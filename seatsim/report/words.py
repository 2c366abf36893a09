"""What reports say in words: how figures are made, and what an effect means to the owner of a rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

from seatsim.diagnosis.result import Cause, Estimate
from seatsim.report.formatting import describe_effect, format_quantity, format_sentence
from seatsim.schema.fields import validated
from seatsim.schema.yaml_text import parse_value


class _EffectWords(NamedTuple):
    """A clause on what is the matter, `{}` being the size of the parameter named, and what to do about it."""

    clause: str
    action: str
    parameter: str = ""


class Words(NamedTuple):
    """The content of `assets/words.yaml`.

    Sentences on the method of each kind of report, conditions of each level of credibility, name and explanation of
    each verdict, and words for each effect.
    """

    methods: Mapping[str, Sequence[str]]
    conditions: Mapping[str, Sequence[str]]
    verdicts: Mapping[str, tuple[str, str]]
    effects: Mapping[str, _EffectWords]


@lru_cache(maxsize=1)
def read_words() -> Words:
    """Return the words of all reports."""
    return validated(Words, parse_value(files(__package__).joinpath("assets/words.yaml").read_text(encoding="utf-8")))


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
