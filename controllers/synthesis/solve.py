"""From a plant to a verified, certified design: scale, check, search, verify, certify, bound."""

from __future__ import annotations

import time
from itertools import chain, islice
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from controllers.synthesis.bound import lower_bound
from controllers.synthesis.certify import certify
from controllers.synthesis.descent import Descent, explore, improve, refine
from controllers.synthesis.design import Design
from controllers.synthesis.modes import require_stabilisable
from controllers.synthesis.norm import Peak, grid_norm, hinf_norm
from controllers.synthesis.objective import Objective
from controllers.synthesis.plant import MATRICES, GeneralisedPlant, Loop, StateSpace
from controllers.synthesis.scaling import scale
from controllers.synthesis.starts import convex_start, starting_gains
from seatsim.errors import InputError, SynthesisError

_FIRST_STARTS, _MORE_STARTS = 6, 24
# Shares of the time budget: starts are explored until the first, the best refined until the second, and improved upon
# until the third; the rest is for proofs.
_EXPLORED, _REFINED, _IMPROVED = 0.35, 0.65, 0.85
_ROUNDING = 1e-10


@overload
def synthesise(
    A: GeneralisedPlant, /, *, max_gain: float = ..., time_budget: float = ..., seed: int = ...
) -> Design: ...
@overload
def synthesise(
    A: StateSpace, /, *, split: tuple[int, int], max_gain: float = ..., time_budget: float = ..., seed: int = ...
) -> Design: ...
@overload
def synthesise(
    A: ArrayLike,
    B1: ArrayLike,
    B2: ArrayLike,
    C1: ArrayLike,
    C2: ArrayLike,
    D11: ArrayLike,
    D12: ArrayLike,
    D21: ArrayLike,
    *,
    max_gain: float = ...,
    time_budget: float = ...,
    seed: int = ...,
) -> Design: ...


def synthesise(
    A: Any,
    B1: Any = None,
    B2: Any = None,
    C1: Any = None,
    C2: Any = None,
    D11: Any = None,
    D12: Any = None,
    D21: Any = None,
    *,
    split: tuple[int, int] | None = None,
    max_gain: float = 1e6,
    time_budget: float = 60.0,
    seed: int = 0,
) -> Design:
    """Find the static output feedback `u = gain @ y` with the smallest H-infinity norm from w to z.

    The plant is given by its eight matrices (shapes: `GeneralisedPlant`), as a `GeneralisedPlant` (which may also keep
    gains at zero), or as a `control.StateSpace` with inputs [w; u], outputs [z; y] and `split = (nw, nz)`.
    `max_gain` bounds every |gain_ij| in the user's units: many infima lie at infinite gain, so quote gamma with it.
    `time_budget` in s: the search stops there, a computation under way may take a few seconds more. The same seed
    gives the same design, unless time runs out. The problem is not convex: the answer is the best of several starts,
    a local optimum with a certificate of its own gamma.

    Raises:
        InputError: a matrix, the split or an option is wrong.
        SynthesisError: no gain can stabilise the plant, or none was found.
    """
    begin = time.monotonic()
    plant = _as_plant((A, B1, B2, C1, C2, D11, D12, D21), split)
    _check_options(max_gain, time_budget)
    scaled = scale(plant)
    require_stabilisable(scaled)
    objective = Objective(scaled.plant, scaled.scaled_gain(np.full(plant.free.shape, float(max_gain))))
    found = _explore(objective, scaled.plant, seed, begin + _EXPLORED * time_budget)
    if not found.candidates:
        raise SynthesisError(_not_stabilised(found, scaled.rate, max_gain, time_budget))
    best = refine(objective, found.candidates, begin + _REFINED * time_budget)
    if not found.agrees:
        best = improve(objective, best, seed, begin + _IMPROVED * time_budget)
    gain = np.clip(scaled.physical_gain(objective.gain(best.entries)), -max_gain, max_gain)
    loop = plant.close(gain)
    peak = verified_norm(loop)
    certificate = certify(loop, peak.value)
    return Design(
        gain=gain,
        gamma=peak.value,
        max_gain=float(max_gain),
        lower_bound=min(lower_bound(plant, gain, certificate, begin + time_budget), peak.value),
        certificate=certificate,
        peak_frequency=peak.frequency,
        poles=loop.poles,
    )


def verified_norm(loop: Loop) -> Peak:
    """Return the H-infinity norm on which bisection and frequency grid agree; where the grid finds more, it leads."""
    norm, grid = hinf_norm(loop), grid_norm(loop)
    return norm if norm.value >= grid.value * (1 - _ROUNDING) else hinf_norm(loop, guesses=[grid.frequency])


def _as_plant(parts: tuple[Any, ...], split: tuple[int, int] | None) -> GeneralisedPlant:
    first, rest = parts[0], parts[1:]
    if isinstance(first, GeneralisedPlant):
        return first
    if hasattr(first, "dt"):
        if split is None:
            raise InputError("a state space needs its split: split=(disturbance inputs, performance outputs)")
        return GeneralisedPlant.from_state_space(first, *split)
    missing = [name for name, part in zip(MATRICES[1:], rest, strict=True) if part is None]
    if missing:
        raise InputError(f"the plant lacks {', '.join(missing)}; give all of {', '.join(MATRICES)}, or a plant object")
    return GeneralisedPlant(*parts)


def _check_options(max_gain: float, time_budget: float) -> None:
    for name, value in (("max_gain", max_gain), ("time_budget", time_budget)):
        if not 0 < value < np.inf:
            raise InputError(f"{name} is {value}; a finite number above 0 is wanted")


def _explore(objective: Objective, plant: GeneralisedPlant, seed: int, deadline: float) -> Descent:
    """Descend from a few starts where all lead to the same value, from many where they do not."""
    starts = starting_gains(plant, seed)
    found = explore(objective, islice(starts, _FIRST_STARTS), deadline)
    if found.agrees:
        return found
    size = float(np.linalg.norm(plant.B1) * np.linalg.norm(plant.C1)) or 1.0
    gamma = found.candidates[0].gamma if found.candidates else size
    convex = convex_start(plant, max(gamma, 1e-9 * size), deadline)
    return found.with_more(explore(objective, chain(convex, islice(starts, _MORE_STARTS)), deadline))


def _not_stabilised(found: Descent, rate: float, max_gain: float, budget: float) -> str:
    return (
        f"no stabilising gain with |gain| <= {max_gain:g} was found from {found.starts} starts in at most "
        f"{budget:g} s; the least spectral abscissa reached is {found.abscissa * rate:.3g} 1/s"
    )
