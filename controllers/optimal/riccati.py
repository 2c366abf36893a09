"""Riccati equations that have no solution in double precision are one clear error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from seatsim.schema.errors import SynthesisError


@contextmanager
def solving(what: str) -> Iterator[None]:
    """Raise SynthesisError where the equation of `what`, which is solved meanwhile, has no solution in numbers.

    Its weights, or its noise, then lie so many orders of magnitude apart that an eigenvalue is lost in rounding.
    """
    try:
        yield
    except (np.linalg.LinAlgError, ValueError) as error:
        raise SynthesisError(
            f"the Riccati equation of the {what} has no solution in numbers ({error}); choose values of its weights or"
            " of its noise that are less far apart"
        ) from error
