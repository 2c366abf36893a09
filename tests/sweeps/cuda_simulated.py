"""Run by `test_cuda.py` in a process of its own, where numba simulates the device: a sweep by two engines, compared."""

import sys
from pathlib import Path

import pandas as pd

import seatsim
from seatsim.simulation import simulate
from seatsim.sweeps.engines.choice import open_engine
from seatsim.sweeps.execute import execute, prepare


def main() -> None:
    folder = Path(sys.argv[1])
    # The loop of single runs in Python too: nothing is compiled.
    simulate.compiled = lambda function, parts: function
    frames = []
    for engine in ("cuda", "local"):
        with open_engine(engine, 1, None) as carry_out:
            execute(prepare(folder / "sweep.yaml"), folder / engine, carry_out)
        frames.append(seatsim.read_sweep(folder / engine))
    pd.testing.assert_frame_equal(*frames, rtol=1e-9, atol=1e-12)
    print(f"{len(frames[0])} rows agree")


if __name__ == "__main__":
    main()
