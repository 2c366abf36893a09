"""The kernel of a CUDA device: all that a lane may hold compiles for one, with no card in the machine."""

from types import SimpleNamespace

import pytest

from seatsim.scenario.loading import load
from seatsim.sweeps.device import as_device_lane

from ..conftest import SEAT
from ..text import beside, parse

SCENARIOS = parse(beside(__file__, "cuda_lanes.yaml"))


@pytest.mark.parametrize("settings", SCENARIOS.values(), ids=SCENARIOS)
def test_the_kernel_compiles_without_a_card(tmp_path, monkeypatch, settings):
    pytest.importorskip("numba_cuda", reason='needs pip install "seatsim[cuda]"')
    from numba import cuda
    from numba.cuda import dispatcher

    from seatsim.kernel.cuda_lanes import SIGNATURE, make_kernel

    path = tmp_path / "seat.yaml"
    path.write_text(SEAT)
    lane = as_device_lane(0, load(path, settings)[0])
    # Functions that a kernel calls ask for the card that they are compiled for.
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: SimpleNamespace(compute_capability=(9, 0)))
    code, _ = cuda.compile_ptx(make_kernel(lane.start), SIGNATURE, cc=(9, 0))
    assert ".target sm_90" in code and ".entry" in code
