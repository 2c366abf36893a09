"""An excitation of the menu, optimised in amplitude, band and current by a search without derivatives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from seatsim.diagnosis.design.candidate_experiments import EXCITATIONS, CandidateExperiment, excite
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.schema.arrays import Array

_FIRST_STEP = 0.6
"""First step of the search in the natural logarithm of a key: a factor of 1.8."""
_LARGEST_FACTOR = 2.4
"""Largest factor on a key, either way: the sweep then ends below 50 Hz, which a step of 2 ms resolves."""


def optimise_excitation(
    problem: DiagnosisProblem, name: str, score: Callable[[CandidateExperiment], float], trials: int
) -> None:
    """Search the free keys of an excitation for the least score, by Nelder and Mead's simplex in their logarithms.

    Args:
        problem: the recording, whose coil bounds the current.
        name: of the excitation in the menu.
        score: called with every excitation that is tried; it keeps the best.
        trials: most excitations that are tried, about four for each free key.
    """
    free = EXCITATIONS[name].free
    largest = np.log(_LARGEST_FACTOR)

    def score_at(logarithms: Array) -> float:
        return score(excite(problem, name, dict(zip(free, np.exp(logarithms).tolist(), strict=True))))

    corners = np.vstack([np.zeros(len(free)), _FIRST_STEP * np.eye(len(free))])
    minimize(
        score_at, corners[0], method="Nelder-Mead", bounds=[(-largest, largest)] * len(free),
        options={"maxfev": trials, "initial_simplex": corners},
    )  # fmt: skip
