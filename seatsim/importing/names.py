"""What the names of columns mean, in English, German, French and Chinese (pinyin): a quantity, a place, a unit.

A word of four letters and more counts wherever it stands in a name, a shorter one only where it stands alone.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from seatsim.schema.units import DIMENSIONS, find_conversion

QUANTITIES: Mapping[str, tuple[str, ...]] = {
    "acceleration": ("acceleration", "accel", "acc", "a", "beschleunigung", "beschl", "acz", "az", "jiasudu"),
    "displacement": (
        "displacement", "disp", "stroke", "travel", "position", "deflection", "weg", "federweg", "einfederung", "hub",
        "auslenkung", "deplacement", "debattement", "course", "weiyi", "xingcheng", "x", "s", "lvdt",
    ),
    "velocity": ("velocity", "speed", "geschwindigkeit", "geschw", "vitesse", "sudu", "v"),
    "force": ("force", "load", "kraft", "effort", "zunili", "li", "f", "fd"),
    "current": ("current", "strom", "bestromung", "courant", "intensite", "dianliu", "i"),
    "voltage": ("voltage", "spannung", "tension", "dianya", "u"),
    "temperature": ("temperature", "temp", "temperatur", "wendu", "thermo"),
    "time": ("time", "zeit", "temps", "shijian", "t", "timestamp", "timestamps", "zeitstempel"),
    "distance": ("distance", "chainage", "station", "strecke", "abstand", "juli"),
    "elevation": ("elevation", "height", "profile", "profil", "hohe", "hoehe", "hauteur", "gaodu", "z"),
    "mark": ("valid", "gultig", "gueltig", "segment", "marker", "trigger", "index"),
}  # fmt: skip
"""Words for what a column holds; for a velocity before a displacement, since `x` alone is one."""
PLACES: Mapping[str, tuple[str, ...]] = {
    "frame": ("frame", "rahmen", "gestell", "oberteil", "cadre", "chassis", "kuangjia", "zs"),
    "floor": (
        "floor", "base", "boden", "kabine", "cabin", "cab", "plancher", "cabine", "diban", "platform", "plattform",
        "table", "ground", "basis", "fusspunkt", "z0", "input",
    ),
    "driver": (
        "driver", "fahrer", "occupant", "person", "dummy", "seat", "sitz", "cushion", "kissen", "pad", "conducteur",
        "siege", "assise", "jiashiyuan", "zuoyi", "renti", "zc", "passenger", "body",
    ),
}  # fmt: skip
"""Words for where a sensor is; the first place that fits counts, so that a seat's frame is a frame."""
COMMANDS = (
    "command",
    "commanded",
    "cmd",
    "soll",
    "setpoint",
    "sollwert",
    "consigne",
    "commande",
    "zhiling",
    "target",
    "ref",
    "demand",
)
LATERAL = ("x", "y", "lateral", "longitudinal", "fore", "quer", "laengs", "langs", "ax", "ay", "accx", "accy")
OTHERS = ("ambient", "umgebung", "room", "raum", "engine", "motor")
DAMPERS = ("damper", "dampfer", "daempfer", "amortisseur", "zuni", "load cell", "mrd")
"""Words for commands, for axes other than the vertical, for what belongs to no seat, and for its damper."""
DIMENSION = {
    "acceleration": "acceleration", "displacement": "length", "velocity": "velocity", "force": "force",
    "current": "current", "voltage": "voltage", "temperature": "temperature", "time": "time",
    "distance": "length", "elevation": "length", "angular_acceleration": "angular_acceleration",
}  # fmt: skip
BY_UNIT = ("acceleration", "velocity", "displacement", "force", "current", "voltage", "temperature")
"""Quantities that a unit alone tells, where no word does."""
SHORT_UNITS = ("A", "mA", "N", "kN", "daN", "V", "mV", "g", "C", "K", "F", "m", "cm", "mm", "um", "s", "ms", "us", "s2")
"""Units that end names and could be taken for words."""
LONG = 4
"""Letters from which a word counts inside another one."""


class Meaning(NamedTuple):
    """What a column's name says; `unit` is the one in the name or beside it, None what neither says."""

    quantity: str | None
    place: str | None = None
    is_command: bool = False
    is_lateral: bool = False
    unit: str = ""
    is_damper: bool = False


def read_name(name: str, unit: str = "") -> Meaning:
    """Return what the name of a column says, with the unit that its file states beside it."""
    plain, words = _plain(name), _words(name)
    quantity = _first(QUANTITIES, plain, _words(_before_unit(name))) or _first(QUANTITIES, plain, words)
    if quantity is None and unit:
        quantity = next((each for each in BY_UNIT if is_of(unit, each)), None)
    if any(word in words or (len(word) >= LONG and word in plain) for word in OTHERS):
        return Meaning(None)
    stated = unit or (unit_of_name(name, quantity) if quantity else "")
    return Meaning(
        quantity,
        _first(PLACES, plain, words),
        any(_has(word, plain, words) for word in COMMANDS),
        quantity == "acceleration" and any(word in words for word in LATERAL),
        stated,
        any(_has(word, plain, words) for word in DAMPERS),
    )


def is_of(unit: str, quantity: str) -> bool:
    """Say whether a unit is one of a quantity."""
    wanted = DIMENSIONS[DIMENSION[quantity]] if quantity in DIMENSION else None
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
            if all(len(part) <= LONG for part in parts[-count:]) and not unit.isdigit() and is_of(unit, quantity):
                return unit
    return ""


def _before_unit(name: str) -> str:
    """Return a name without the short units that end it: the `A` of `i_A` is none for an acceleration."""
    parts = re.split(r"[ _]+", name.strip())
    while len(parts) > 1 and parts[-1] in SHORT_UNITS:
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
            if any((len(word) >= LONG) == long and _has(word, plain, words) for word in known):
                return name
    return None


def _has(word: str, plain: str, words: set[str]) -> bool:
    return word in words or (len(word) >= LONG and word in plain)


def _plain(name: str) -> str:
    """Return a name in lower case letters without accents: `Dämpfer` is `dampfer`."""
    folded = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    return "".join(letter for letter in folded if not unicodedata.combining(letter)).lower()


def _words(name: str) -> set[str]:
    """Return the words of a name: parted by what is no letter or digit, and by capitals inside."""
    parted = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name)
    words = set(re.split(r"[^0-9a-z]+", _plain(parted))) | set(re.split(r"[^0-9a-z]+", _plain(name)))
    return (words | {re.sub(r"\d+$", "", word) for word in words if not re.fullmatch(r"z\d", word)}) - {""}
