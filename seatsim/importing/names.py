"""What the names of columns mean, in English, German, French and Chinese (pinyin): a quantity, a place, a unit.

The words stand in `names.yaml`. One of four letters and more counts wherever it stands in a name, a shorter one only
where it stands alone.
"""

import functools
import re
import string
import unicodedata
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from seatsim.schema.fields import read_packaged
from seatsim.schema.units import DIMENSIONS, find_conversion, is_unit

_WORDS = read_packaged(Path(__file__).with_name("names.yaml"), dict[str, dict[str, str]])
_QUANTITIES, _PLACES, _AXES, _MARKS = (
    {name: tuple(words.split()) for name, words in table.items()} for table in _WORDS.values()
)
"""Words for what a column holds, for where a sensor is, for its axis, and for commands and what is of no seat."""
_DAMPERS = ("damper", "dampfer", "daempfer", "amortisseur", "zuni", "load cell", "mrd")
"""Words for what belongs to a damper."""
SI_UNITS = dict.fromkeys(("displacement", "distance", "elevation"), "m") | DIMENSIONS
"""SI units of the quantities that have one."""
_TIMES = dict.fromkeys(("ms", "msec", "millis", "milliseconds"), "ms")
_TIMES |= dict.fromkeys(("sec", "secs", "seconds", "sekunden", "secondes"), "s")
"""Units of time that are names of a column by themselves."""
BY_UNIT = ("acceleration", "velocity", "displacement", "force", "current", "voltage", "temperature")
"""Quantities that a unit alone tells, where no word does."""
_SHORT_UNIT = re.compile("m?[AV]|k?N|daN|[gCKF]|[cmu]?m|[mu]?s|s2")
"""Units that end names and could be taken for words."""
_LONG = 4
"""Letters from which a word counts inside another one."""


class Meaning(NamedTuple):
    """What a column's name says; `unit` is the one in the name or beside it, None what neither says."""

    quantity: str | None
    place: str | None = None
    is_command: bool = False
    axis: str | None = None
    unit: str = ""
    is_damper: bool = False

    @property
    def is_contradicted(self) -> bool:
        """Whether the unit is one of something else: a force in V is the voltage of its sensor."""
        return bool(self.quantity in SI_UNITS and not is_of(self.unit, self.quantity) and is_unit(self.unit))

    @property
    def is_lateral(self) -> bool:
        """Whether it is an acceleration along another axis than the vertical."""
        return self.quantity == "acceleration" and self.axis in ("x", "y")


@functools.lru_cache(maxsize=1024)
def read_name(name: str, unit: str = "") -> Meaning:
    """Return what the name of a column says, with the unit that its file states beside it."""
    plain, words = _plain(name), _words(name)
    if any(_has(word, plain, words) for word in _MARKS["other"]):
        return Meaning(None)
    quantity, stated = _read_quantity(name, unit)
    axis = next((axis for axis, known in _AXES.items() if words & {*known}), None)
    is_command, is_damper = (any(_has(word, plain, words) for word in known) for known in (_MARKS["command"], _DAMPERS))
    return Meaning(quantity, _first(_PLACES, plain, words), is_command, axis, stated, is_damper)


def _read_quantity(name: str, unit: str) -> tuple[str | None, str]:
    """Return what a column holds, and its unit: of the words in its name the one counts that the unit is of.

    A letter gives way to a unit of something else: `v2` in m/s^2 is an acceleration. A whole word does not.
    """
    if not unit and _plain(name).strip() in _TIMES:
        return "time", _TIMES[_plain(name).strip()]
    sure, letters = _rank(name)
    if not unit:
        named = next(((each, found) for each in (*sure, *letters) if (found := unit_of_name(name, each))), None)
        quotient = unit_of_name(name, "acceleration")
        if named is None and not sure and "/" in quotient:
            return "acceleration", quotient
        return named or (next(iter((*sure, *letters)), None), "")
    fitting = next((each for each in (*sure, *letters) if is_of(unit, each)), None)
    by_unit = next((each for each in (*BY_UNIT, "time") if is_of(unit, each)), None)
    if fitting is None and (by_unit is not None or is_unit(unit)):
        return (sure[0] if sure else by_unit), unit
    return fitting or next(iter((*sure, *letters)), None), unit


def _rank(name: str) -> tuple[list[str], list[str]]:
    """Return the quantities that words of a name mean, whole words and long ones first; then those of letters."""
    plain, words = _plain(name), _words(name)
    longs = {each: [word for word in known if len(word) >= _LONG] for each, known in _QUANTITIES.items()}
    alone = [each for each, known in longs.items() if words & {*known}]
    inside = {each: max((len(word) for word in known if word in plain), default=0) for each, known in longs.items()}
    parts = sorted((each for each in inside if inside[each] and each not in alone), key=lambda each: -inside[each])
    sure = [*alone, *parts]
    both = (_words(_before_unit(name)), words)
    letters = [each for some in both for each, known in _QUANTITIES.items() if some & {*known} and each not in sure]
    return sure, list(dict.fromkeys(letters))


def is_of(unit: str, quantity: str) -> bool:
    """Say whether a unit is one of a quantity."""
    if quantity == "frequency":
        return unit.lower() in ("hz", "khz")
    wanted = SI_UNITS.get(quantity)
    return wanted is not None and (unit == wanted or find_conversion(unit, wanted) is not None)


def quantity_of(channel: str) -> str:
    """Return what a channel of a recording holds: a current where it is called `current_command`."""
    word = channel.rpartition("_")[2]
    return "current" if word == "command" else word


def unit_of_name(name: str, quantity: str) -> str:
    """Return the unit that ends a name, such as `m/s2` of `acc_z_m_s2`, empty where none does."""
    parts = re.split(r"[ _,]+", name.strip())
    for count in (3, 2, 1):
        if len(parts) > count:
            unit = "_".join(parts[-count:]).replace("_", "/", 1)
            # A long word is no unit, and need not be looked up in a large table.
            if all(len(part) <= _LONG for part in parts[-count:]) and not unit.isdigit() and is_of(unit, quantity):
                return unit
    return ""


def _before_unit(name: str) -> str:
    """Return a name without the short units that end it: the `A` of `i_A` is none for an acceleration."""
    parts = re.split(r"[ _]+", name.strip())
    while len(parts) > 1 and _SHORT_UNIT.fullmatch(parts[-1]):
        parts.pop()
    return "_".join(parts)


def without_unit(name: str, unit: str) -> str:
    """Return a name in lower case, without the unit that ends it."""
    plain = "_".join(re.split(r"[^0-9a-z]+", _plain(name))).strip("_")
    ending = "_".join(re.split(r"[^0-9a-z]+", unit.lower())).strip("_")
    return plain.removesuffix(f"_{ending}") if ending else plain


def _first(words_by_name: Mapping[str, Iterable[str]], plain: str, words: set[str]) -> str | None:
    """Return the name of which a long word is in a text, else that of which a short word stands alone."""
    for long in (True, False):
        for name, known in words_by_name.items():
            if any((len(word) >= _LONG) == long and _has(word, plain, words) for word in known):
                return name
    return None


def _has(word: str, plain: str, words: set[str]) -> bool:
    return word in words or (len(word) >= _LONG and word in plain)


def _plain(name: str) -> str:
    """Return a name in lower case letters without accents: `Dämpfer` is `dampfer`."""
    folded = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    return "".join(letter for letter in folded if not unicodedata.combining(letter)).lower()


def _words(name: str) -> set[str]:
    """Return the words of a name: parted by what is no letter or digit, and by capitals inside."""
    parted = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name)
    words = set(re.split(r"[^0-9a-z]+", _plain(parted))) | set(re.split(r"[^0-9a-z]+", _plain(name)))
    return (words | {word.rstrip(string.digits) for word in words if not re.fullmatch(r"z\d", word)}) - {""}
