"""Columns of bench tables: the quantity that each holds, recognised by its name, in SI units.

A column is called by its quantity, followed by its unit where that is not the SI unit: `displacement_mm`, `force_kN`,
`velocity_m_s`, also written `Displacement [mm]` or `velocity (m/s)`. A force may name its current, `force_0p4A_N`.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from seatsim.schema import tables
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.units import OWN_SPELLINGS, USUAL, conversion
from seatsim.schema.yaml_source import Source

if TYPE_CHECKING:
    import pandas as pd


_QUANTITIES: dict[str, tuple[tuple[str, ...], str]] = {
    "time": (("time", "t"), "s"),
    "displacement": (("displacement", "stroke", "position", "x"), "m"),
    "velocity": (("velocity", "speed", "v"), "m/s"),
    "force": (("force", "damper_force", "f"), "N"),
    "current": (("current", "coil_current", "i"), "A"),
    "command": (("current_command", "current_cmd", "command"), "A"),
    "voltage": (("voltage", "command_voltage"), "V"),
    "temperature": (("temperature", "damper_temperature"), "degC"),
    "segment": (("segment",), ""),
    "valid": (("valid",), ""),
}
"""Names of every quantity, and its SI unit, in which a bare name is; usual units and spellings may follow a name."""
DRIVES = ("current", "command", "voltage")
"""Quantities that state the damper's input, in the order of preference."""
_NEEDED = ("time", "displacement", "force")
_FORCE_AT = re.compile(r"(?:damper_)?force_(\d+(?:[p.]\d+)?)a(?:_(k?n))?")
_MISSPELT = 0.9
"""Similarity to a known name (by difflib) above which an unknown column is taken for a misspelling."""
_LISTED = 12
"""Most columns that an error lists."""
_RATES = ("sample_rate_Hz", "sample_rate")


class Meaning(NamedTuple):
    """What a column holds: a quantity in a unit, that of SI where it is empty; `at`, the current in A that it names."""

    quantity: str
    unit: str = ""
    at: float | None = None

    def in_si(self, values: Array) -> Array:
        """Return values of the column in SI units (degC)."""
        if not self.unit:
            return values
        found = conversion(self.unit, _QUANTITIES[self.quantity][1])
        return values * found.factor + found.zero


def _known() -> dict[str, Meaning]:
    known = {}
    for quantity, (names, si) in _QUANTITIES.items():
        units = (*USUAL.get(si, ()), *(unit for unit in OWN_SPELLINGS.get(si, {}) if unit[0].isalpha()))
        for name in names:
            known[name] = Meaning(quantity)
            known |= {_named(name, unit).lower(): Meaning(quantity, unit if unit != si else "") for unit in units}
    return known


def _named(name: str, unit: str) -> str:
    """Return the name of a column that ends in a unit, such as `velocity_m_s`."""
    return f"{name}_{re.sub('[/ ]', '_', unit)}"


KNOWN = _known()
"""Every name that a column may have, in lower case."""


class Columns(NamedTuple):
    """The columns of a table: name by quantity, forces by the current in their names (or None), those not used."""

    by_quantity: dict[str, str]
    forces: dict[float | None, str]
    unused: tuple[str, ...]


def meaning(column: str) -> Meaning | None:
    """Return what a column of this name holds, None where the name is not known."""
    plain = re.sub(r"[^0-9a-z.]+", "_", column.lower()).strip("_")
    at = _FORCE_AT.fullmatch(plain)
    if at:
        return Meaning("force", "kN" if at[2] == "kn" else "", float(at[1].replace("p", ".")))
    return KNOWN.get(plain)


def columns_of(names: Iterable[str], file: Path) -> Columns:
    """Return what the columns of a table hold.

    Raises:
        InputError: two columns hold the same, or the name of one is misspelt.
    """
    found, forces, unused = dict[str, str](), dict[float | None, str](), list[str]()
    for name in names:
        known = meaning(name)
        if known is None:
            unused.append(name)
            continue
        other = forces.get(known.at) if known.quantity == "force" else found.get(known.quantity)
        if other is not None:
            raise InputError(f"{file}: '{other}' and '{name}' both hold the {known.quantity}; rename or remove one")
        if known.quantity == "force":
            forces[known.at] = name
        else:
            found[known.quantity] = name
    for name in unused:
        close = difflib.get_close_matches(name.lower(), KNOWN, n=1, cutoff=_MISSPELT)
        quantity = KNOWN[close[0]].quantity if close else "nothing"
        if close and quantity not in {*found, *(["force"] if forces else [])}:
            raise InputError(f"{file}: column '{name}' is not known; name it {_spelt(quantity)}, or remove it")
    return Columns(found, forces, tuple(unused))


def numbers(frame: pd.DataFrame, column: str, file: Path) -> Array:
    """Return a column of a table in SI units, shape (N,).

    Raises:
        InputError: a row of it is no finite number.
    """
    known = meaning(column)
    values, bad = tables.numbers(frame, column)
    if bad.size:
        more = f" (and {bad.size - 1} more rows)" if bad.size > 1 else ""
        raise InputError(
            f"{file}, line {frame.index[bad[0]] + 2}, {column}: '{frame[column].iloc[bad[0]]}'{more} is not a finite"
            " number; correct it, or mark such rows by 0 in a column 'valid'"
        )
    return known.in_si(values) if known else values


def check_needed(there: Iterable[str], columns: Sequence[str], file: Path) -> None:
    """Raise InputError, with the nearest column, at the first quantity that a bench table needs and this one lacks."""
    lacking = [quantity for quantity in _NEEDED if quantity not in set(there)]
    if lacking:
        quantity = lacking[0]
        hint, others = nearest(quantity, columns), ", ".join(_QUANTITIES[quantity][0][1:])
        rate = f", or give '{_RATES[0]}' in {file.name.partition('.csv')[0]}.yaml" if quantity == "time" else ""
        raise InputError(
            f"{file}: no column holds the {quantity}{hint}; name it {_spelt(quantity)} (also {others} with the unit)"
            f"{rate}; there are {', '.join(columns[:_LISTED])}{', ...' * (len(columns) > _LISTED)}"
        )


def _spelt(quantity: str) -> str:
    units = USUAL.get(_QUANTITIES[quantity][1], ())
    return " or ".join(f"'{_named(quantity, unit)}'" for unit in units) or f"'{quantity}'"


def constants(sidecar: Source) -> dict[str, float]:
    """Return what a sidecar states of a whole table, by quantity in SI units; `rate` is the sample rate in Hz.

    Numbers count under the names that a column may have; everything else is a description.

    Raises:
        InputError: a number is not finite, or the sample rate is not positive.
    """
    found: dict[str, float] = {}
    for key, value in sidecar.data.items():
        known = meaning(str(key))
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        if not np.isfinite(value) or (key in _RATES and value <= 0.0):
            raise sidecar.error((key,), f"{value} is not permitted; write a finite number, above 0 for a sample rate")
        if key in _RATES:
            found.setdefault("rate", float(value))
        elif known and known.quantity in (*DRIVES, "temperature"):
            found[known.quantity] = float(known.in_si(np.asarray(value, dtype=float)))
    return found
