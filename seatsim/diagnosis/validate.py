"""How far the gap shrinks, on a run that took no part in the fit."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.decide import movements
from seatsim.diagnosis.fit import Engine, Point, State
from seatsim.diagnosis.nuisance import varied
from seatsim.diagnosis.problem import Problem
from seatsim.diagnosis.result import Gaps
from seatsim.recordings.gap import measure_gap, pool_runs
from seatsim.scenario.scenario import Scenario

Array = NDArray[np.float64]

BLOCK = 1.0
"""s; length of the blocks that are drawn again and again."""
DRAWS = 400
"""Bootstrap samples."""
LEVEL = (5.0, 95.0)
"""Percentiles of the interval."""
ELSEWHERE = 0.1
"""Standard deviation by which the shrink differs between excitations that are alike."""
SPARED, MOVED = 0.6, 0.05
"""Share of what an effect moves in all runs that one held out may have at most, and has to have at least."""


def shrinks(problem: Problem, nominal: State, chosen: State) -> Array:
    """Return by how much the gap shrinks in each run from one state to another."""
    return 1.0 - sizes(problem, chosen) / sizes(problem, nominal)


def sizes(problem: Problem, state: State) -> Array:
    """Return the gap of each run in standard deviations of the channels, shape (runs,)."""
    powers = [np.mean((state.residual[run] / problem.spread[:, None]) ** 2) for run in problem.runs]
    return np.asarray(np.sqrt(powers))


def held_out(engine: Engine, chosen: State, shrink: Array) -> str:
    """Return the run to hold out: at the lower quartile of shrink among those that the effects move, as they do others.

    A run of another kind shrinks less than those that made an effect plain enough to be found.
    """
    runs = engine.problem.runs
    if not chosen.point.terms or len(runs) < 2:
        return runs[-1]
    shares = []
    for run in runs:
        part = dataclasses.replace(engine.problem, runs=(run,))
        moves = movements(Engine(part, engine.white), chosen)
        shares.append([float(np.mean(move**2)) for move in moves])
    share = np.array(shares) / np.maximum(np.sum(shares, axis=0), 1e-12)
    worst = share.max(axis=1)
    spared = worst < max(SPARED, 1.001 * worst.min())
    moved = spared & (share.min(axis=1) > MOVED)
    good = sorted(np.flatnonzero(moved if moved.any() else spared), key=lambda k: shrink[k])
    return runs[good[(len(good) - 1) // 4]]


def trained(engine: Engine, state: State, run: str) -> tuple[State, State]:
    """Return the calibrated and the augmented rig, both fitted without a run."""
    problem = engine.problem
    rest = tuple(name for name in problem.runs if name != run) or problem.runs
    part = Engine(dataclasses.replace(problem, runs=rest), engine.white)
    calibrated = part.refitted(Point(problem.rest))
    return calibrated, part.refitted(state.point) if state.point.terms else calibrated


def scenario_at(problem: Problem, nominal: Scenario, point: Point) -> Scenario:
    """Return the nominal scenario with the parameters and effects of a point."""
    return dataclasses.replace(varied(nominal, problem.parameters, point.u), effects=(*nominal.effects, *point.effects))


def gaps(problem: Problem, scenarios: Sequence[Scenario], runs: Sequence[str], spread: float) -> Gaps:
    """Return the gaps of the nominal, the calibrated and the augmented scenario on some runs.

    `spread` is the standard deviation of the shrink from run to run; a scenario left as it is shrinks no gap anywhere.
    """
    before, calibrated, after = (measure_gap(scenario, problem.recording, runs) for scenario in scenarios)
    shrink = 1.0 - after.overall / before.overall
    changed = (scenarios[0], scenarios[2])
    interval = _interval(problem, changed, runs, shrink, spread) if shrink else (0.0, 0.0)
    return Gaps(_stated(before), _stated(calibrated), _stated(after), dict(before.floor), shrink, interval)


def _stated(found: Any) -> dict[str, Any]:
    return {"overall": found.overall, "channels": found.channels}


def _interval(
    problem: Problem, scenarios: tuple[Scenario, Scenario], runs: Sequence[str], shrink: float, spread: float
) -> tuple[float, float]:
    """Return the block bootstrap of the shrink, widened by what other excitations make of it."""
    measured, first = pool_runs(scenarios[0], problem.recording, runs)
    second = pool_runs(scenarios[1], problem.recording, runs)[1]
    length = max(1, round(BLOCK * problem.recording.header.sample_rate))
    count = max(1, len(next(iter(measured.values()))) // length)
    powers = np.array([
        [_blocks((measured[name] - course[name]) / np.std(measured[name]), count, length) for name in measured]
        for course in (first, second)
    ])  # fmt: skip
    rng = np.random.default_rng(0)
    drawn = powers[:, :, rng.integers(0, count, (DRAWS, count))].mean(axis=(1, 3))
    samples = 1.0 - np.sqrt(drawn[1] / drawn[0]) + np.hypot(ELSEWHERE, spread) * rng.standard_normal(DRAWS)
    low, high = np.percentile(samples, LEVEL)
    return float(min(low, shrink)), float(min(1.0, max(high, shrink)))


def _blocks(values: Array, count: int, length: int) -> Array:
    return np.asarray(np.mean(values[: count * length].reshape(count, -1) ** 2, axis=1))
