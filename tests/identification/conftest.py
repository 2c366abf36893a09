"""Shared bench data."""

import pytest

from .benches import BINGHAM, sines, write


@pytest.fixture(scope="session")
def bench(tmp_path_factory):
    """A folder with three sine tests of a Bingham damper, 2 % noise."""
    return write(sines(BINGHAM), tmp_path_factory.mktemp("bench"))


@pytest.fixture(scope="session", autouse=True)
def one_thread():
    """Small products of matrices are slower on several threads, which other tests need."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1):
        yield
