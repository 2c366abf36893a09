"""Clusters: the engine `dask`, and an array script for Slurm, each of whose tasks runs a share of a sweep.

A task of dask is a part of the sweep with the values of its runs, so that a worker needs nothing but seatsim, the files
that the scenario names and the user's own code, at the same paths. A task whose worker dies is given to another one.
"""

from __future__ import annotations

import logging
import os
import shlex
import signal
import socket
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from seatsim.provenance.statement import list_versions
from seatsim.schema.errors import InputError, RunError
from seatsim.schema.files import make_folder, write_text
from seatsim.schema.modules import started_elsewhere, use_all, used_files
from seatsim.sweeps.engines import Outcome, Work, simulate_one
from seatsim.sweeps.folder import LIBRARIES, list_differences
from seatsim.sweeps.parts import part_of
from seatsim.sweeps.plan import Plan, Selection

if TYPE_CHECKING:
    from distributed import Client, Future

_EXTRA = 'engine dask needs an extra; install it with: pip install "seatsim[cluster]"'
_AHEAD = 4
"""Tasks for each worker that are sent before it has asked for them, so that it never waits for one."""
LONGEST_SEARCH = 60
"""Seconds in which a scheduler must answer."""


@contextmanager
def open_cluster(jobs: int, address: str | None) -> Iterator[_ClusterEngine]:
    """Connect with the scheduler at an address, or start a cluster of `jobs` processes, which ends with the block.

    Raises:
        InputError: dask is not installed, no scheduler answers at the address, or it has no worker.
    """
    try:
        import distributed  # noqa: F401
    except ImportError as error:
        raise InputError(_EXTRA) from error
    # What goes wrong is said once, by the error that reaches the user.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with _embed(jobs) if address is None else _connect(address) as client:
        try:
            client.wait_for_workers(1, timeout=LONGEST_SEARCH)
        except TimeoutError as error:
            problem = f"the dask scheduler has no worker; start some with 'dask worker {client.scheduler.address}'"
            raise InputError(problem) from error
        yield _ClusterEngine(client)


class _ClusterEngine(NamedTuple):
    """Simulates runs on the dask cluster of a client."""

    client: Client

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield the outcomes of each task as it ends.

        Raises:
            RunError: the cluster was lost.
        """
        from distributed import as_completed

        waiting, own_code = iter(work.tasks), used_files()
        # What a worker is given beside the runs: where histories go, the user's own code, the versions it must have.
        given = work.histories.resolve() if work.histories else None, own_code, list_versions(LIBRARIES, own_code)

        def submit(count: int) -> list[Future]:
            parts = [work.plan.select(runs) for runs in islice(waiting, count)]
            return [self.client.submit(_simulate, part, *given, pure=False) for part in parts]

        running = as_completed(submit(_AHEAD * len(self.client.scheduler_info()["workers"])))
        for future in running:
            yield _await_outcomes(future)
            future.release()
            running.update(submit(1))


@contextmanager
def _embed(jobs: int) -> Iterator[Client]:
    from distributed import Client, LocalCluster

    options = {"dashboard_address": ":0", "silence_logs": logging.CRITICAL}
    with (
        started_elsewhere(),
        LocalCluster(n_workers=jobs, threads_per_worker=1, **options) as cluster,
        Client(cluster) as client,
    ):
        try:
            yield client
        finally:
            # By itself a worker ends its task first; nobody waits for it any more.
            for nanny in cluster.workers.values():
                if nanny.pid:
                    os.kill(nanny.pid, signal.SIGKILL)


@contextmanager
def _connect(address: str) -> Iterator[Client]:
    from distributed import Client

    try:
        client = Client(address, timeout=LONGEST_SEARCH)
    except (OSError, ValueError) as error:
        raise InputError(
            f"--address {address}: no dask scheduler answers there; start one with 'dask scheduler', and workers with"
            f" 'dask worker {address}'"
        ) from error
    with client:
        yield client


def _await_outcomes(future: Future) -> list[Outcome]:
    """Return the outcomes of a task.

    Raises:
        RunError: the scheduler was lost, the task ended one worker after the other, or its worker has other versions.
    """
    from asyncio import CancelledError as CancelledTaskError
    from concurrent.futures import CancelledError

    from distributed import KilledWorker

    try:
        outcomes: list[Outcome] = future.result()
    except (KilledWorker, CancelledError, CancelledTaskError, OSError) as error:
        raise RunError(f"the cluster was lost ({type(error).__name__}: {error}); go on with --resume") from error
    return outcomes


def _simulate(
    selection: Selection, histories: Path | None, own_code: tuple[Path, ...], versions: Mapping[str, str]
) -> list[Outcome]:
    """Simulate the runs of a task; called on a worker.

    Raises:
        RunError: the worker has other versions than the command, so that its figures may be others.
    """
    use_all(own_code)
    here = list_versions(LIBRARIES, own_code)
    if here != versions:
        differences = "; ".join(list_differences(versions, here))
        raise RunError(
            f"the worker on {socket.gethostname()} is not like this machine: {differences}; install the same there, and"
            " go on with --resume"
        )
    return [simulate_one(selection.plan, inner, number, histories) for number, inner in selection.runs]


_MOST_TASKS = 256
"""Tasks of an array, well below the 1001 that Slurm permits unless it is configured otherwise."""
_SCRIPT = Path(__file__).with_name("slurm.sh")
"""Array script, with the names of what is put in."""


def write_slurm(
    script: Path, file: Path, folder: Path, plan: Plan, keep_histories: bool, own_code: Sequence[Path]
) -> Path:
    """Write the script for a sweep `file` whose rows go to `folder`; paths in it are absolute, and quoted.

    Raises:
        InputError: the script or the folder cannot be written, or a path has a line break, which would end its line.
    """
    for path in (script, file, folder, *own_code):
        if not str(path.resolve()).isprintable():
            raise InputError(
                f"{str(path)!r}: a path in a script for Slurm has no line break or other control character; rename it"
            )
    make_folder(folder)
    words = ["seatsim", "sweep", str(file.resolve()), "--out", str(folder.resolve())]
    words += ["--keep", "histories"] if keep_histories else []
    words += [word for path in own_code for word in ("--with", str(path.resolve()))]
    logs = str(folder.resolve()).replace("%", "%%") + "/slurm-%a.log"  # a single % begins a pattern of Slurm
    names = {"file": file.name, "name": f"seatsim-{file.stem}", "script": str(script), "logs": logs}
    text = _SCRIPT.read_text(encoding="utf-8").format(
        runs=plan.runs,
        command=shlex.join(words),
        tasks=min(part_of(plan.runs - 1) + 1, _MOST_TASKS),
        **{key: shlex.quote(name) for key, name in names.items()},
    )
    return write_text(script, text)
