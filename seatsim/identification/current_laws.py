"""Laws in the current: polynomials `c0 + c1 i + c2 i^2 + ...` that a model's field holds the coefficients of."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import get_args, get_type_hints

import numpy as np
from pydantic.fields import FieldInfo

from seatsim.schema.arrays import Array


@cache
def is_current_law(cls: type, field: str) -> bool:
    """Whether a tuple field holds the coefficients of a polynomial in the current: units `-`, `1/A`, `1/A^2`, ..."""
    hint = get_type_hints(cls, include_extras=True)[field]
    units = [_unit(part) for part in get_args(get_args(hint)[0])]
    return len(units) > 1 and units[:2] == ["", "1/A"]


def _unit(hint: object) -> str:
    """Return the unit that an annotated type states, an empty text where it states none."""
    for part in get_args(hint)[1:]:
        if isinstance(part, FieldInfo) and isinstance(part.json_schema_extra, dict):
            return str(part.json_schema_extra.get("unit", ""))
    return ""


def evaluate_law(coefficients: Sequence[float], currents: Array) -> Array:
    """Return a law's values, shape (N,), at currents in A of shape (N,)."""
    return np.asarray(np.polynomial.polynomial.polyval(currents, np.array(coefficients)), dtype=float)


def interpolate_law(values: Array, end: float) -> list[float]:
    """Return the coefficients of the law with these values, shape (K,), at K currents spread evenly over 0 to `end`."""
    # The system is solved in the current over `end`, where it is better conditioned.
    powers = np.vander(np.linspace(0.0, 1.0, len(values)), increasing=True)
    return [float(c / end**k) for k, c in enumerate(np.linalg.solve(powers, values))]
