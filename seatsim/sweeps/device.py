"""Engine `cuda`: runs that share their models side by side on a CUDA device, the others on this machine.

What a lane of the device has no room for, and what does not reach its end there, is given to the engine `local`: it
simulates the run again and says why.
"""

from __future__ import annotations

import warnings
from collections.abc import Generator, Sequence
from contextlib import suppress
from importlib.util import find_spec
from typing import NamedTuple

from numba.core import config

from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError, RunError, SeatsimError
from seatsim.simulation.runs import measure_run
from seatsim.simulation.validity import list_reasons
from seatsim.sweeps.engines import LocalEngine, Work
from seatsim.sweeps.outcome import Outcome, floor_of, outcome_of
from seatsim.sweeps.plan import Plan

_AT_ONCE = 32_768
"""Runs that are made ready together, as many as the largest devices simulate at once."""
_EXTRA = 'engine cuda needs an extra; install it with: pip install "seatsim[cuda]"'


def check_device(keep_histories: bool) -> None:
    """Refuse what this engine cannot do, before anything is written.

    Raises:
        InputError: histories are to be kept, the extra is not installed, or there is no CUDA device.
    """
    if keep_histories:
        raise InputError("--engine cuda: no histories are kept on the device; choose --keep none, or --engine local")
    # The target for cards within numba itself cannot type the models.
    if not config.ENABLE_CUDASIM and find_spec("numba_cuda") is None:
        raise InputError(_EXTRA)
    from seatsim.kernel.cuda_lanes import has_device

    if not has_device():
        raise InputError(
            "--engine cuda: no CUDA device can be used here: there is no NVIDIA card, or its driver is not installed;"
            " choose --engine local or dask"
        )


class CudaEngine(NamedTuple):
    """Simulates runs on the device, and up to `jobs` others at once on this machine."""

    jobs: int

    def __call__(self, work: Work) -> Generator[list[Outcome]]:
        """Yield the outcomes of the device batch by batch, then those of the other runs.

        Raises:
            RunError: the device failed.
        """
        runs, others = [run for task in work.tasks for run in task], list[int]()
        for first in range(0, len(runs), _AT_ONCE):
            batch = runs[first : first + _AT_ONCE]
            outcomes = _simulate_on_device(work.plan, batch)
            done = {outcome.run for outcome in outcomes}
            others += [run for run in batch if run not in done]
            yield outcomes
        if others:
            warnings.warn(
                f"{len(others)} of {len(runs)} runs are simulated on the processor: those that the device has no room"
                " for (effects, sensors, self-heating and others), and those that did not reach their end there",
                stacklevel=2,
            )
            yield from LocalEngine(self.jobs)(work._replace(tasks=[others]))


def _simulate_on_device(plan: Plan, runs: Sequence[int]) -> list[Outcome]:
    """Return the outcomes of the runs that reached their end on the device.

    Raises:
        RunError: the device failed.
    """
    from seatsim.simulation.device import simulate_on_device

    read = [(run, scenario) for run in runs if (scenario := _read(plan, run))]
    scenarios = [scenario for _, scenario in read]
    outcomes = []
    try:
        for place, history in simulate_on_device(scenarios, floor_of):
            number, scenario = read[place]
            with suppress(SeatsimError):
                metrics = measure_run(scenario, history)
                reason = "; ".join(list_reasons(scenario, history, metrics))
                outcomes.append(outcome_of(number, scenario.seed, metrics, reason))
    except Exception as error:  # numba and the driver have many errors of their own
        raise RunError(
            f"the CUDA device failed ({type(error).__name__}: {error}); what has ended is kept: go on with --resume and"
            " --engine local"
        ) from error
    return outcomes


def _read(plan: Plan, run: int) -> Scenario | None:
    """Return the scenario of a run, None where it is wrong: the engine `local` says why."""
    try:
        return plan.scenario(run)
    except SeatsimError:
        return None
