"""Engine `dask`: the same bytes on an embedded cluster and on one that was started beside it."""

import pytest

from seatsim.sweeps import parts

from .conftest import bytes_of

distributed = pytest.importorskip("distributed")


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch):
    """Make tasks of ten runs; there are more of them than are sent at once."""
    monkeypatch.setattr(parts, "RUNS_OF_PART", 10)


@pytest.fixture
def address():
    """Start a scheduler with a worker, and return its address."""
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as cluster:
        yield cluster.scheduler_address


@pytest.mark.parametrize("beside", [False, True])
def test_a_cluster_gives_the_same_bytes(beside, write_sweep, tmp_path, seatsim_command, request):
    path = write_sweep(runs=103)
    where = ["--address", request.getfixturevalue("address")] if beside else ["--jobs", "2"]
    assert seatsim_command("sweep", path, "--out", tmp_path / "local")[0] == 0
    assert seatsim_command("sweep", path, "--out", tmp_path / "dask", "--engine", "dask", *where)[0] == 0
    assert bytes_of(tmp_path / "dask") == bytes_of(tmp_path / "local")
