"""The command line as a script calls it."""

from ..cli.conftest import here, seatsim_command, undrawn

__all__ = ["here", "seatsim_command", "undrawn"]
