"""What is timed beside seatsim computes the same."""

import shutil

import pytest


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("gcc"), reason="needs gcc")
@pytest.mark.parametrize("source", ["loop.c", "lean.c"])
def test_c_agrees_with_seatsim(source, tmp_path, benchmark):
    peers, seat = benchmark("loop_peers"), benchmark("seat_run")
    acceleration, setup = seat.make_floor(2.0), seat.make_setup(5)
    _, history = seat.prepare_run(acceleration, setup)
    run, channels = benchmark("c_loop").native_run(source, tmp_path, acceleration, setup)
    run()
    peers.check_agreement(channels, history, peers.AGREEMENT[source])
