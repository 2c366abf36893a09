"""What becomes of one run of a sweep: its state, the reason for it, and its metrics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.compilation.messages import explain
from seatsim.excitations.base import Excitation, Floor
from seatsim.metrics.table import METRICS, Metric
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import SeatsimError
from seatsim.simulation.result import Run
from seatsim.simulation.runs import measure_run, write_histories
from seatsim.simulation.simulate import simulate
from seatsim.simulation.validity import list_reasons

DONE, FAILED, UNVERIFIED = "done", "failed", "unverified"
STATES = (DONE, FAILED, UNVERIFIED)
FLOORS_KEPT = 8
"""Floors that are kept for the next runs; of 60 s at 1 kHz each takes 1.5 MB."""


class Outcome(NamedTuple):
    """The outcome of a run by its number.

    `done` has metrics that can be used; those of `unverified` cannot be relied on, and `failed` has none. `metrics` are
    in the order of `METRICS`, None where there is no such figure.
    """

    run: int
    state: str
    reason: str
    seed: int
    metrics: tuple[float | None, ...]


def simulate_run(number: int, make_scenario: Callable[[], Scenario], histories: Path | None) -> Outcome:
    """Simulate one run and return its outcome; nothing that goes wrong in it ends the sweep.

    `histories` is a folder in which the channels are kept, or None.
    """
    seed = 0
    try:
        scenario = make_scenario()
        seed = scenario.seed
        # What grows beyond all numbers is said by the state of the run, once.
        with np.errstate(over="ignore", invalid="ignore"):
            history = simulate(scenario, floor_of(scenario))
            metrics = measure_run(scenario, history)
        if histories is not None:
            write_histories([Run(scenario, history, metrics)], histories / f"run-{number:07d}.parquet")
        reason = "; ".join(list_reasons(scenario, history, metrics))
    except SeatsimError as error:
        return Outcome(number, FAILED, str(error), seed, (None,) * len(METRICS))
    except Exception as error:  # a model of the user's own may raise anything, and the other runs go on
        return Outcome(number, FAILED, explain(error), seed, (None,) * len(METRICS))
    return outcome_of(number, seed, metrics, reason)


def outcome_of(number: int, seed: int, metrics: Mapping[str, Metric], reason: str) -> Outcome:
    """Return the outcome of a run that reached its end; `reason` is why its figures are unverified, mostly empty."""
    figures = tuple(metrics[name].value if name in metrics else None for name in METRICS)
    return Outcome(number, UNVERIFIED if reason else DONE, reason, seed, figures)


def floor_of(scenario: Scenario) -> Floor | None:
    """Return the floor of a scenario, from the floors kept where it is among them; None where it has none."""
    if scenario.excitation is None:
        return None
    with scenario.placed("excitation"):
        cls = type(scenario.excitation)
        kind = f"{cls.__module__}.{cls.__qualname__}"
        return _make_floor(kind, scenario.excitation, scenario.solver.step, scenario.seed)


@lru_cache(maxsize=FLOORS_KEPT)
def _make_floor(kind: str, excitation: Excitation, step: float, seed: int) -> Floor:
    # Its class is part of the key, as records of two classes with the same values are equal.
    return excitation.floor(step, seed)
