"""Engines by name."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

from seatsim.schema.errors import InputError
from seatsim.sweeps.engines.base import Engine
from seatsim.sweeps.engines.local import LocalEngine


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
    return nullcontext(LocalEngine(jobs))
