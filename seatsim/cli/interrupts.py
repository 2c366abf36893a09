"""The end of a command by a signal: soon, whatever it is doing.

Ctrl-C (SIGINT) and SIGTERM raise KeyboardInterrupt in the main thread: what a command keeps is written, temporary
folders are removed, the status is 128 and the number of the signal (130, 143). Python can only do so between two of its
own instructions. Where the main thread compiles, runs compiled code or waits for other threads, another one ends the
process `GRACE` seconds after the signal.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import time
from contextlib import suppress
from threading import Thread
from types import FrameType
from typing import NoReturn

from seatsim.cli.begin import SIGNALS, say_interrupted
from seatsim.schema.guarded import remove_leftovers

GRACE = 1.2
"""Seconds from a signal to the end of a process that does not end by itself."""
_PATIENCE = 10.0
"""Seconds for which that end waits for files that are being put in place."""
_received: list[int] = []


def end(status: int) -> NoReturn:
    """End the process; threads and the orderly end of compiled code, which takes a second, are not waited for."""
    for stream in (sys.stdout, sys.stderr):
        # Whoever read the output may have closed it.
        with suppress(BrokenPipeError):
            stream.flush()
    remove_leftovers(_PATIENCE)
    # Python would wait for threads: after an interrupt, for as long as the runs take that have begun.
    os._exit(128 + _received[-1] if _received else status)


def watch_signals() -> None:
    """Raise KeyboardInterrupt at each signal that is not ignored, and watch that the process ends."""
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    for number in SIGNALS:
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
    while (number := wakeups.recv(1)[0]) not in SIGNALS:
        pass
    time.sleep(GRACE)
    try:
        remove_leftovers(_PATIENCE)
        say_interrupted()
    finally:
        os._exit(128 + number)
