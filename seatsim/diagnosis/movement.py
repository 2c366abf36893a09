"""How much effects and gaps matter: movements of the channels in their standard deviations."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from seatsim.diagnosis.objective import Evaluation, Objective
from seatsim.diagnosis.problem import LEAST_REMOVABLE, DiagnosisProblem, normalise_rms_errors
from seatsim.schema.arrays import Array

_COLOUR = 0.5
"""Excess that the colour of a sensor's noise may leave of a channel; its stated RMS is taken as that of white noise."""


def measure_movements(problem: DiagnosisProblem, evaluation: Evaluation) -> list[Array]:
    """Return by how much each effect of a set moves each channel, in the channel's standard deviations.

    The movement is the RMS change of the simulation over all runs when this effect alone is removed.
    """
    parameters = evaluation.parameters
    without = [parameters.remove(term.effect) for term in parameters.terms]
    others = problem.residuals([(other.deviations, other.effects) for other in without])
    moves = []
    for other in others:
        change = np.concatenate([other[run] - evaluation.residuals[run] for run in problem.runs], axis=1)
        moves.append(np.sqrt(np.mean(change**2, axis=1)) / problem.spread)
    return moves


def measure_relative_movements(problem: DiagnosisProblem, evaluation: Evaluation) -> list[Array]:
    """Return the movements relative to what makes one material: a stated size, or the channel's noise if it is more."""
    return [relate_to_material(problem, move) for move in measure_movements(problem, evaluation)]


def relate_to_material(problem: DiagnosisProblem, movements: Array) -> Array:
    """Return movements of the channels relative to what is material, shape (channels,)."""
    return movements / np.maximum(problem.settings.decision.material, problem.noise / problem.spread)


def is_material(problem: DiagnosisProblem, evaluation: Evaluation) -> bool:
    """Whether every effect of a set moves some channel by a material size and by more than its noise."""
    return all(np.any(move > 1.0) for move in measure_relative_movements(problem, evaluation))


def measure_remainders(problem: DiagnosisProblem, evaluation: Evaluation) -> Array:
    """Return the gap of every channel beyond its noise, in the channel's standard deviations, shape (channels,)."""
    residuals = np.concatenate([evaluation.residuals[run] for run in problem.runs], axis=1)
    power = np.mean(residuals**2, axis=1) - problem.noise**2
    return np.asarray(np.sqrt(np.maximum(power, 0.0)) / problem.spread)


def _measure_channel_excess(evaluation: Evaluation) -> Array:
    """Return the whitened excess (reduced chi-square less 1) of every channel, shape (channels,)."""
    by_run = [np.mean(values**2, axis=1) for values in evaluation.whitened.values()]
    return np.asarray(np.mean(by_run, axis=0) - 1.0)


def measure_shares_left(problem: DiagnosisProblem, before: Evaluation, after: Evaluation) -> list[float]:
    """Return the share of the excess, but for coloured noise, that is left of each channel with a material gap."""
    gaps = measure_remainders(problem, before)
    excess, left = _measure_channel_excess(before), np.maximum(_measure_channel_excess(after) - _COLOUR, 0.0)
    settings = problem.settings
    channels = np.flatnonzero((gaps > settings.decision.material) & (excess > settings.selection.nothing_left))
    return [float(left[k] / excess[k]) for k in channels]


def measure_gap_taken(objective: Objective, before: Evaluation, after: Evaluation) -> float:
    """Return the share that a rig takes off the part of the gap that a right model would take off, over all runs."""
    gaps = [
        float(np.sqrt(np.mean(normalise_rms_errors(objective.problem, each.residuals) ** 2)))
        for each in (before, after)
    ]
    return share_removable(objective, gaps[0], gaps[1])


def share_removable(objective: Objective, before: float, after: float) -> float:
    """Return the share of the removable gap that is taken, from the gap before and after, as the contract states them.

    `(before - after) / (before - left)`, in standard deviations, with `left` the gap that the noise weights expect
    of a right model; 1 where noise alone makes the gap.
    """
    problem = objective.problem
    left = np.sqrt(np.mean([expect_power(objective, run)[0] / problem.spread**2 for run in problem.runs]))
    removable = float(before - left)
    return (before - after) / removable if removable > LEAST_REMOVABLE else 1.0


def expect_power(objective: Objective, run: str) -> tuple[Array, Array]:
    """Return the mean square that a right model leaves of each channel in a run, and its standard deviation by chance.

    Both have the shape (channels,). Above the frequencies that are compared the spectrum goes on as it ends there. The
    power of noise at a frequency has as large a standard deviation as its mean.
    """
    samples = objective.problem.measured[run].shape[1]
    power = objective.weights.expect(run)
    counts = np.ones(power.shape[1])
    counts[-1] += samples // 2 + 1 - power.shape[1]
    return power @ counts * 2.0 / samples**2, np.sqrt(power**2 @ counts) * 2.0 / samples**2


def group_equivalent(names: frozenset[str], equivalent: Iterable[frozenset[str]]) -> list[list[str]]:
    """Return groups of effects that could stand for each other: equivalent sets that differ in one effect.

    An effect that stands for one of `names`, the chosen, counts as that one in the other sets.
    """
    groups: dict[str, list[str]] = {}
    # Sets that differ least come first: the substitutes found there are known when sets that differ more are compared.
    for other in sorted(equivalent, key=lambda other: len(other - names)):
        stands_for = {member: name for name, group in groups.items() for member in group}
        missing, added = names - {stands_for.get(name, name) for name in other}, other - names - set(stands_for)
        if len(other) == len(names) and len(missing) == len(added) == 1:
            (replaced,), (stand_in,) = missing, added
            groups.setdefault(replaced, [replaced]).append(stand_in)
    return list(groups.values())
