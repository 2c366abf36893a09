"""The start of a command as a process of its own, and its orderly end.

At its first instants, before anything heavy is imported, a signal ends it with a word, not a traceback. This
module imports next to nothing itself.
"""

from __future__ import annotations

import gc
import os
import signal
import sys

# For annotations only: the module `typing` takes longer to load than everything that is done here.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import NoReturn

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


def begin() -> NoReturn:
    """Run the command line; until `seatsim.cli.interrupts` watches signals, one ends the process at once."""
    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)
    # Imports make many objects that stay; to look for garbage among them again and again takes a tenth of a short run.
    gc.set_threshold(100_000)
    from seatsim.cli.interrupts import end, watch_signals

    watch_signals()
    status = 0
    try:
        from seatsim.cli.app import main

        main()
    except KeyboardInterrupt:
        say_interrupted()
    except SystemExit as ended:
        if isinstance(ended.code, str):
            raise
        status = ended.code or 0
    end(status)


def _end(number: int, frame: FrameType | None) -> NoReturn:
    say_interrupted()
    os._exit(128 + number)
