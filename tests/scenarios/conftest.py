"""The command line as a script calls it."""

from ..cli.conftest import here, undrawn

__all__ = ["here", "undrawn"]
