"""Libraries of formats, which are installed with `pip install "seatsim[formats]"`."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from seatsim.schema.errors import InputError


def need(module: str, kind: str) -> ModuleType:
    """Return an imported library of the extra `formats`.

    Raises:
        InputError: it is not installed; the sentence names the command that installs it.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise InputError(
            f'{kind} is read by {module.partition(".")[0]}; install it with: pip install "seatsim[formats]"'
        ) from error
