"""Which signals end a command, and with which word; nothing heavy is imported here."""

from __future__ import annotations

import os
import signal
import sys

SIGNALS = (signal.SIGINT, signal.SIGTERM)


def say_interrupted() -> None:
    """Say why the command ends, by system calls alone, as what it prints with may be locked or not be loaded."""
    try:
        if os.isatty(2):
            os.write(2, b"\x1b[?25h")  # a progress bar hides the cursor
        os.write(2, b"error: interrupted\n")
        if "--json" in sys.argv:
            os.write(1, b'{"error": "interrupted"}\n')
    except OSError:  # whoever read the output may have closed it
        pass
