"""How the true rig is compiled, and the arrays its functions work on.

numba keeps compiled code beside each source and looks only at that file's date: after an edit of a function that is
called from another module, delete the `__pycache__` of this package.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numba

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a function and keep the result on disk.

    Plain IEEE arithmetic, without the reordering that the kernel under test allows itself.
    """
    done: F = numba.njit(cache=True)(function)
    return done
