"""How the true rig is compiled, and the types its compiled functions see."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., Any])


class Parameters:
    """The parameter record as compiled code sees it: every slot is a float (see `slots`)."""

    def __getattr__(self, name: str) -> float:
        """Return a slot."""
        raise AttributeError(name)


def compiled(function: F) -> F:
    """Compile a function and keep the result on disk."""
    done: F = numba.njit(cache=True)(function)
    return done
