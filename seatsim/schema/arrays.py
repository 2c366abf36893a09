"""The array that signals, matrices and tables are held in, and arrays that code of the user's own gives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.errors import RunError

Array = NDArray[np.float64]


def require_samples(values: object, giver: str, count: int, step: float) -> Array:
    """Return samples as an array of float64 and shape (count,), taken every `step` seconds.

    Raises:
        RunError: they are no numbers, others in number, or one of them is not finite; the error begins with `giver`,
            which says whose samples they are.
    """
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RunError(f"{giver} gives {type(values).__name__}, not an array of numbers") from error
    if found.shape != (count,):
        raise RunError(f"{giver} gives an array of shape {found.shape}; it must be of shape ({count},)")
    bad = np.flatnonzero(~np.isfinite(found))
    if bad.size:
        raise RunError(f"{giver} gives {found[bad[0]]} at sample {bad[0]}, {bad[0] * step:.6g} s; it must be finite")
    return found
