"""What simulates batches of runs for engine `local`: a thread of its process, or a process of its own.

A process is `python -m seatsim.sweeps.engines.worker NUMBER`, with the number of the connection to its parent.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from multiprocessing.connection import Connection
from pathlib import Path

from threadpoolctl import threadpool_limits

from seatsim.schema.modules import use_all
from seatsim.sweeps.engines.base import simulate_one
from seatsim.sweeps.engines.memory import keep_freed_memory
from seatsim.sweeps.outcome import Outcome
from seatsim.sweeps.plan import Plan

LONGEST_WAIT = 0.2
"""Seconds after which a worker hands over what it has, so that little is lost where the sweep is killed."""


def simulate_batches(connection: Connection, plan: Plan, histories: Path | None) -> None:
    """Simulate the batches of run numbers that come over a connection, and send lists of their outcomes back.

    Raises:
        EOFError: the other end was closed. OSError: the same, while outcomes were sent.
    """
    keep_freed_memory()
    # Libraries of linear algebra get one thread: the other processors simulate other runs.
    with threadpool_limits(1):
        while True:
            batch: list[int] = connection.recv()
            found: list[Outcome] = []
            since = time.monotonic()
            for run in batch:
                found.append(simulate_one(plan, run, run, histories))
                if time.monotonic() - since > LONGEST_WAIT:
                    connection.send(found)
                    found, since = [], time.monotonic()
            if found:
                connection.send(found)


def main() -> None:
    """Say with an empty list that this process is ready, take the plan, and simulate until the parent ends."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with Connection(int(sys.argv[1])) as connection:
        try:
            use_all(connection.recv())
            connection.send([])
            simulate_batches(connection, *connection.recv())
        except (EOFError, OSError):
            return


def _end_with_parent() -> None:
    """End this process with its parent, which holds the other end of standard input, in the middle of a run too."""
    os.read(sys.stdin.fileno(), 1)
    os._exit(1)


if __name__ == "__main__":
    main()
