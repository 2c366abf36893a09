"""What is timed computes the same on both sides, and the command says what it leaves out."""

import importlib
import json
import shutil

import numpy as np
import pytest

from seatsim.benchmark import native, parts, peers
from seatsim.benchmark.measurement import Cost
from seatsim.benchmark.seat_run import make_floor, make_setup, prepare_run
from seatsim.kernel.channels import CHANNELS

from ..cli.conftest import seatsim_command

__all__ = ["seatsim_command"]


@pytest.mark.skipif(not shutil.which("gcc"), reason="needs gcc")
@pytest.mark.parametrize("source", peers.AGREEMENT)
def test_c_agrees_with_seatsim(source, tmp_path):
    acceleration, setup = make_floor(2.0), make_setup(5)
    _, history = prepare_run(acceleration, setup)
    run, channels = native.native_run(source, tmp_path, acceleration, setup)
    run()
    for name, values in channels.items():
        ours = history[:, CHANNELS.index(name)]
        assert values == pytest.approx(ours, abs=peers.AGREEMENT[source] * np.nanmax(np.abs(ours)), nan_ok=True)


@pytest.mark.parametrize(
    ("package", "what"), [("numbalsoda", "LSODA"), ("numbalsoda", "DOP853"), ("heyoka", 1), ("heyoka", 4)]
)
def test_general_solvers_agree_with_scipy(package, what):
    pytest.importorskip(package, reason=f"needs {package}")
    solver = importlib.import_module(f"seatsim.benchmark.{package}_run").make_solver(what)
    acceleration = make_floor(0.2)
    exact = peers.solve_tightly(acceleration)
    for channel, values in solver(1e-8, acceleration, peers.SAMPLE_EVERY).items():
        assert values == pytest.approx(exact[channel], abs=1e-4 * np.max(np.abs(exact[channel])))


def test_the_command_prints_costs_and_says_what_it_leaves_out(seatsim_command, monkeypatch):
    known = {
        "length": parts.Part("by length", lambda: iter([Cost("run of 1 s", 100.0, "ns a step", 1.0, "itself")])),
        "c": parts.Part("in C", lambda: iter(()), "this machine has no gcc"),
    }
    monkeypatch.setattr(parts, "list_parts", lambda dampers: known)
    status, out, err = seatsim_command("bench", "--json")
    answer = json.loads(out)
    assert status == 0 and "c is left out: this machine has no gcc" in err
    assert answer["left_out"] == {"c": "this machine has no gcc"}
    assert answer["costs"][0] == {"part": "length", "what": "run of 1 s", "value": 100.0, "unit": "ns a step",
                                  "ratio": 1.0, "beside": "itself"}  # fmt: skip
    for arguments, sentence in ((["lenght"], "did you mean"), (["--model", "bouc_wenn"], "no damper is called")):
        status, _, err = seatsim_command("bench", *arguments)
        assert status == 2 and sentence in err
