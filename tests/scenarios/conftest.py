"""The command line as a script calls it."""

from ..cli.conftest import undrawn

__all__ = ["undrawn"]
