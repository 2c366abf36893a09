"""Run by `test_cuda.py` in a process of its own, where numba simulates the device: a sweep by two engines, compared."""

import sys
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from numba.cuda.simulator.kernel import BlockManager, BlockThread

import seatsim
from seatsim.kernel import step
from seatsim.simulation import simulate
from seatsim.sweeps.execute import execute, open_engine, prepare


def run_in_turn(manager, grid_point, *arguments):
    """Run the threads of a block one after another; numba's simulator polls them, which takes as long again."""
    for point in np.ndindex(*manager._block_dim):
        thread = BlockThread(lambda: manager._f(*arguments), manager, grid_point, point, manager._debug)
        thread.start()
        thread.join()
        if thread.exception:
            raise thread.exception[0]


def main() -> None:
    folder = Path(sys.argv[1])
    BlockManager.run = run_in_turn
    # All in Python: nothing is compiled.
    simulate.compiled = lambda function, parts: function
    step._advance_divided = step._advance_divided.py_func
    frames = []
    with warnings.catch_warnings(record=True) as told:
        for engine in ("cuda", "local"):
            with open_engine(engine, 1, None) as carry_out:
                execute(prepare(folder / "sweep.yaml"), folder / engine, carry_out)
            frames.append(seatsim.read_sweep(folder / engine))
    pd.testing.assert_frame_equal(*frames, rtol=1e-9, atol=1e-12)
    print(*(each.message for each in told if each.category is UserWarning), f"{len(frames[0])} rows agree", sep="\n")


if __name__ == "__main__":
    main()
