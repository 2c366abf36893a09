"""The start of a command as a process of its own, and its end: in order, or soon after a signal, whatever it is doing.

Ctrl-C (SIGINT) and SIGTERM raise KeyboardInterrupt in the main thread: what a command keeps is written, temporary
folders are removed, the status is 128 and the number of the signal (130, 143). Python can only do so between two of its
own instructions. Where the main thread compiles, runs compiled code or waits for other threads, another one ends the
process `GRACE` seconds after the signal. Nothing heavy is imported before signals are watched.
"""

from __future__ import annotations

import gc
import os
import signal
import socket
import sys
import time
from contextlib import suppress
from threading import Thread
from types import FrameType
from typing import NoReturn

from seatsim.schema.guarded import remove_leftovers

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
GRACE = 1.2
"""Seconds from a signal to the end of a process that does not end by itself."""
_PATIENCE = 10.0
"""Seconds for which that end waits for files that are being put in place."""
_received: list[int] = []


def begin() -> NoReturn:
    """Run the command line."""
    watch_signals()
    # Imports make many objects that stay; to look for garbage among them again and again takes a tenth of a short run.
    gc.set_threshold(100_000)
    status = 0
    try:
        from seatsim.cli.app import main

        main()
    except KeyboardInterrupt:
        _say_interrupted()
    except SystemExit as ended:
        if isinstance(ended.code, str):
            raise
        status = ended.code or 0
    for stream in (sys.stdout, sys.stderr):
        # Whoever read the output may have closed it.
        with suppress(BrokenPipeError):
            stream.flush()
    remove_leftovers(_PATIENCE)
    # Python would wait for threads, after an interrupt for as long as the runs take that have begun, and a second for
    # the orderly end of compiled code.
    os._exit(128 + _received[-1] if _received else status)


def watch_signals() -> None:
    """Raise KeyboardInterrupt at each signal that is not ignored, and watch that the process ends."""
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    for number in _SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _interrupt)
    signal.set_wakeup_fd(theirs.detach(), warn_on_full_buffer=False)
    Thread(target=_end_in_time, args=(ours,), daemon=True).start()


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    _received.append(number)
    raise KeyboardInterrupt


def _end_in_time(wakeups: socket.socket) -> None:
    """Wait for a signal, which the system reports at once, then end the process where it has not ended by itself.

    The main thread may have lost its KeyboardInterrupt, and may hold any lock, that of imports too: nothing that is
    done here waits for one.
    """
    while (number := wakeups.recv(1)[0]) not in _SIGNALS:
        pass
    time.sleep(GRACE)
    try:
        remove_leftovers(_PATIENCE)
        _say_interrupted()
    finally:
        os._exit(128 + number)


def _say_interrupted() -> None:
    """Say why the command ends, by system calls alone, as what it prints with may be locked or not be loaded."""
    with suppress(OSError):  # whoever read the output may have closed it
        if os.isatty(2):
            os.write(2, b"\x1b[?25h")  # a progress bar hides the cursor
        os.write(2, b"error: interrupted\n")
        if "--json" in sys.argv:
            os.write(1, b'{"error": "interrupted"}\n')
