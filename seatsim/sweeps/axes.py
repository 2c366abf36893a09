"""The values that one key takes: a list, a range, or a distribution that is drawn from; specimens of a damper."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.schema.arrays import Array
from seatsim.schema.json_schema import Schema, mapping_schema
from seatsim.schema.validation import check_keys, is_finite_number, mapping, read_number, read_whole
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath, parse_value

DISTRIBUTIONS = {
    "uniform": "[low, high]",
    "normal": "[mean, standard deviation]",
    "lognormal": "[mean, standard deviation of the log]",
    "choice": "{value: probability, ...}",
}
"""Names of distributions, and what each takes."""
_TAKEN = ", ".join(f"{name}: {takes}" for name, takes in DISTRIBUTIONS.items())
_FORMS = f"a list, {{from: A, to: B, steps: N}}, or a distribution: {_TAKEN}"
_MOST_STEPS = 1_000_000
"""Of a range; more would be a slip of the keyboard."""
_SLIGHTLY = 1e-9
"""By how much probabilities may miss the sum of 1, for the sake of rounding."""
_EDGE = 2.0**-53
"""Probability in either tail that no draw reaches: a quantile at 0 or 1 may be infinite."""


SPECIMENS = "from"
"""Key under `vary` of a file with specimens of a damper."""


class Axis(NamedTuple):
    """A varied key: its values where these are listed, and in any case its quantile function.

    `values` are the stated ones in order, None of a distribution. `quantile` maps probabilities, shape (N,), to values;
    those of a list are equally likely. The key of specimens is `SPECIMENS`; each value is a mapping of keys to values,
    and `model` that of their damper.
    """

    key: str
    values: tuple[object, ...] | None
    quantile: Callable[[Array], list[object]]
    model: str = ""


def read_axis(key: str, source: Source) -> Axis:
    """Return the values of a key, as they stand under `vary` in a sweep file.

    Raises:
        InputError: they are no list, range or distribution, or its numbers do not fit each other.
    """
    where: KeyPath = ("vary", key)
    stated = mapping(source.data["vary"], source, ("vary",))[key]
    if key == SPECIMENS:
        return _read_specimens(stated, source, where)
    if isinstance(stated, list):
        if not stated:
            raise source.error(where, "the list is empty; state at least one value")
        return _listed(key, stated)
    if not isinstance(stated, Mapping):
        raise source.error(where, f"{stated!r} is a single value; permitted: {_FORMS}")
    if {"from", "to", "steps"} & set(stated):
        return _listed(key, _read_range(stated, source, where))
    return Axis(key, None, _read_distribution(stated, source, where))


def _read_specimens(stated: object, source: Source, where: KeyPath) -> Axis:
    if not isinstance(stated, str):
        raise source.error(where, "state the file that 'seatsim identify' writes of several specimens")
    file = Source(source.path.parent / stated)
    each = mapping(file.data.get("specimens"), file, ("specimens",))
    values = [mapping(of, file, ("specimens", name)) for name, of in each.items()]
    if "model" not in file.data or not values or any(set(of) != set(values[0]) for of in values):
        raise file.error(
            ("specimens",), "states no 'model', or not the same keys of every specimen; identify them anew"
        )
    return _listed(SPECIMENS, values)._replace(model=str(file.data["model"]))


def _listed(key: str, values: Sequence[object]) -> Axis:
    return Axis(key, tuple(values), _choose(values, np.full(len(values), 1 / len(values))))


def _choose(values: Sequence[object], probabilities: Array) -> Callable[[Array], list[object]]:
    edges = np.cumsum(probabilities)[:-1]
    return lambda u: [values[index] for index in np.searchsorted(edges, u, side="right")]


def _read_range(stated: Mapping[str, object], source: Source, where: KeyPath) -> list[object]:
    check_keys(stated, ("from", "to", "steps"), source, where)
    for name in ("from", "to", "steps"):
        if not is_finite_number(stated.get(name)):
            problem = f"{stated.get(name)!r} is not a finite number; a range is {{from: A, to: B, steps: N}}"
            raise source.error((*where, name), problem)
    ends, steps = [stated["from"], stated["to"]], read_whole(stated["steps"], source, (*where, "steps"), 2, _MOST_STEPS)
    values = np.linspace(float(str(ends[0])), float(str(ends[1])), steps).tolist()
    whole = all(isinstance(end, int) for end in ends) and all(value.is_integer() for value in values)
    # Whole numbers stay what they are: keys such as `seed` take no others.
    return [int(value) for value in values] if whole else values


def _read_distribution(stated: Mapping[str, object], source: Source, where: KeyPath) -> Callable[[Array], list[object]]:
    check_keys(stated, (*DISTRIBUTIONS, "low", "high"), source, where)
    named = [name for name in DISTRIBUTIONS if name in stated]
    if len(named) != 1:
        raise source.error(where, f"states {' and '.join(named) or 'no values'}; permitted: {_FORMS}")
    kind = named[0]
    if kind in ("uniform", "choice") and {"low", "high"} & set(stated):
        raise source.error(where, f"low and high truncate normal and lognormal; {kind} takes {DISTRIBUTIONS[kind]}")
    if kind == "choice":
        return _read_choice(stated["choice"], source, (*where, kind))
    first, second = _read_pair(stated[kind], kind, source, (*where, kind))
    if kind == "uniform":
        return lambda u: (first + u * (second - first)).tolist()
    low, high = _read_truncation(stated, source, where)
    if kind == "normal":
        return lambda u: _truncated_normal(u, first, second, low, high).tolist()
    return lambda u: np.exp(_truncated_normal(u, first, second, _log(low), _log(high))).tolist()


def _read_pair(values: object, kind: str, source: Source, where: KeyPath) -> tuple[float, float]:
    if not (isinstance(values, list) and len(values) == 2 and all(map(is_finite_number, values))):
        raise source.error(where, f"{values!r} is not permitted; {kind} takes {DISTRIBUTIONS[kind]}")
    first, second = map(float, values)
    if kind == "uniform" and not first < second:
        raise source.error(where, f"{values!r} is not permitted; the second number must be greater than the first")
    if kind != "uniform" and not second > 0:
        raise source.error(where, f"{second:g} is not permitted; a standard deviation must be greater than 0")
    return first, second


def _read_truncation(stated: Mapping[str, object], source: Source, where: KeyPath) -> tuple[float, float]:
    stops = {"low": -math.inf, "high": math.inf}
    stops |= {name: read_number(stated[name], source, (*where, name)) for name in stops if name in stated}
    low, high = stops.values()
    if not low < high:
        raise source.error((*where, "high"), f"{high:g} is not permitted; it must be greater than low, {low:g}")
    return low, high


def _truncated_normal(u: Array, mean: float, deviation: float, low: float, high: float) -> Array:
    # scipy.stats takes as long to load as many runs take, and most sweeps and all commands do without.
    from scipy.stats import truncnorm

    ends, inside = ((low - mean) / deviation, (high - mean) / deviation), np.clip(u, _EDGE, 1 - _EDGE)
    drawn: Array = truncnorm.ppf(inside, *ends, loc=mean, scale=deviation)
    return drawn


def _read_choice(stated: object, source: Source, where: KeyPath) -> Callable[[Array], list[object]]:
    shares = mapping(stated, source, where)
    for value, share in shares.items():
        if not is_finite_number(share) or share < 0:
            raise source.error((*where, value), f"{share!r} is not permitted; a probability is at least 0")
    probabilities = np.array(list(shares.values()), dtype=float)
    if not shares or abs(probabilities.sum() - 1) > _SLIGHTLY:
        raise source.error(where, f"the probabilities sum to {probabilities.sum():g}; they must sum to 1")
    return _choose([parse_value(value) for value in shares], probabilities)


def _log(value: float) -> float:
    return math.log(value) if value > 0 else -math.inf


def axis_schema() -> Schema:
    """Return the JSON Schema of the values of a key."""
    number: Schema = {"type": "number"}
    pair: Schema = {"type": "array", "items": number, "minItems": 2, "maxItems": 2}
    ends = {"low": number, "high": number}
    steps: Schema = {"from": number, "to": number, "steps": {"type": "integer", "minimum": 2, "maximum": _MOST_STEPS}}
    choice: Schema = {"type": "object", "additionalProperties": number}
    forms = [
        mapping_schema(steps, steps),
        mapping_schema({"uniform": pair}, ("uniform",)),
        mapping_schema({"normal": pair, **ends}, ("normal",)),
        mapping_schema({"lognormal": pair, **ends}, ("lognormal",)),
        mapping_schema({"choice": choice}, ("choice",)),
    ]
    return {"anyOf": [{"type": "array", "minItems": 1}, *forms]}
