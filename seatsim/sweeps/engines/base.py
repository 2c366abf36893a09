"""What an engine is given and what it returns, and engines by name."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import NamedTuple, Protocol

from seatsim.schema.errors import InputError
from seatsim.sweeps.outcome import Outcome, simulate_run
from seatsim.sweeps.plan import Plan


class Work(NamedTuple):
    """The runs of a sweep that are to be simulated: tasks of run numbers, each from one part of the sweep.

    `histories` is a folder in which channels are kept, or None.
    """

    plan: Plan
    tasks: Sequence[Sequence[int]]
    histories: Path | None


class Engine(Protocol):
    """Carries out work; one that takes lanes of one combination of models regroups the runs of several tasks."""

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield outcomes as they come, in any order and in lists of any length; each run of the work has one.

        Where the iterator is closed, as on an interrupt, nothing of it keeps the process from ending.
        """


def simulate_one(plan: Plan, run: int, number: int, histories: Path | None) -> Outcome:
    """Simulate run `run` of a plan, which has this `number` in the sweep."""
    return simulate_run(number, lambda: plan.scenario(run), histories)


def open_engine(
    name: str, jobs: int, address: str | None, keep_histories: bool = False
) -> AbstractContextManager[Engine]:
    """Return what opens the engine that is called `name`: so many runs at once, or on the scheduler at an address.

    Raises:
        InputError: the engine is not available here, or it takes no address, or keeps no histories.
    """
    if address is not None and name != "dask":
        raise InputError(f"--address {address}: engine '{name}' takes none; add --engine dask")
    if name == "cuda":
        from seatsim.sweeps.engines.device import CudaEngine, check_device

        check_device(keep_histories)
        return nullcontext(CudaEngine(jobs))
    if name == "dask":
        from seatsim.sweeps.engines.cluster import open_cluster

        return open_cluster(jobs, address)
    from seatsim.sweeps.engines.local import LocalEngine

    return nullcontext(LocalEngine(jobs))
