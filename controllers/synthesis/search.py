"""The search for one gain on one or several plants, on as few of them at a time as decide."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.synthesis.descent import (
    Descent,
    StabilisingGain,
    StartingGain,
    explore,
    generate_starting_gains,
    improve,
    refine,
)
from controllers.synthesis.global_proof import MOST_GAINS, prove_no_better
from controllers.synthesis.objective import NormObjective
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.scaling import ScaledPlant, scale
from seatsim.schema.arrays import Array
from seatsim.schema.errors import SynthesisError

# A few starts tell an easy problem, where all lead to the same value. Where they do not, as many follow at a time until
# the last half of all starts lowered the norm no more.
_STARTS = 6
# Shares of the time budget: starts are explored until the first; where none is stable, until the second a proof that
# none can be is tried, and until the third starts are explored again. The best is refined until the third and improved
# upon until the fourth; the rest is for proofs.
_EXPLORED, _PROVEN, _REFINED, _IMPROVED = 0.3, 0.4, 0.5, 0.93
# Share of the time left that a search of some of the plants may take: others may have to join them.
_SUBSET = 0.4
# A plant left out of the search counts as covered where its norm is no higher than this times the searched ones'.
_COVERED = 1 + 1e-7
# Further starts go on while they lower the norm by more than this factor.
_GAINED = 1 - 1e-4

Progress = Callable[[str], object]


class TimeBudget(NamedTuple):
    """When the search began, by `time.monotonic()`, and how many seconds it has."""

    begin: float
    budget: float

    def after(self, share: float) -> float:
        """Return the time at which a share of the budget is spent."""
        return self.begin + share * self.budget

    def part(self, share: float) -> TimeBudget:
        """Return a clock that begins now, with a share of the time that is left."""
        now = time.monotonic()
        return TimeBudget(now, share * max(self.begin + self.budget - now, 0.0))


def search(
    plants: Sequence[GeneralisedPlant], max_gain: float, seed: int, clock: TimeBudget, progress: Progress
) -> Array:
    """Return the best gain (nu, ny) found, of entries no larger than `max_gain`.

    The first and the last plant are searched together; then whichever is worst with the gain found joins them, until
    none is worse.

    Raises:
        SynthesisError: no gain can stabilise one of the plants, or none was found for all.
    """
    first = scale(plants[0])
    scaled = [first, *(scale(plant, like=first) for plant in plants[1:])]
    for each in scaled:
        require_stabilisable(each)
    limit, unit = (first.scaled_gain(np.full(plants[0].free.shape, size)) for size in (max_gain, 1.0))
    everything = NormObjective([each.plant for each in scaled], limit, unit)
    chosen = sorted({0, len(scaled) - 1})
    best: StabilisingGain | None = None
    while True:
        objective = everything.on([scaled[i].plant for i in chosen])
        progress(f"plants {', '.join(map(str, chosen))} of {len(plants)}" if len(plants) > 1 else "searching")
        part = clock.part(1.0 if len(chosen) == len(scaled) else _SUBSET)
        starts = generate_starting_gains(objective.plants, objective.gain(objective.unit), seed)
        if best is not None:
            known = StartingGain(objective.gain(best.entries), objective.gain(objective.sizes(best.entries)))
            starts = chain([known], starts)
        found = _explore(objective, starts, part)
        if not found.candidates:
            _require_hope([plants[i] for i in chosen], max_gain, part.after(_PROVEN))
            while not found.candidates and time.monotonic() < part.after(_REFINED):
                found = found.with_more(explore(objective, islice(starts, _STARTS), part.after(_REFINED)))
        if not found.candidates:
            raise SynthesisError(
                f"no stabilising gain with |gain| <= {max_gain:g} was found from {found.starts} starts in at most"
                f" {clock.budget:g} s; the least spectral abscissa reached is {found.abscissa * first.rate:.3g} 1/s"
            )
        best = _lowest(objective, found, starts, seed, part, progress)
        norms = [everything.on([each.plant]).norm(best.entries) for each in scaled]
        worst = int(np.argmax(norms))
        if norms[worst] <= best.gamma * _COVERED or worst in chosen:
            gain = first.physical_gain(everything.gain(best.entries))
            return np.clip(gain, -max_gain, max_gain) * everything.free
        chosen.append(worst)


def _explore(objective: NormObjective, starts: Iterator[StartingGain], clock: TimeBudget) -> Descent:
    """Descend from a few starts where all lead to the same value, from many where not, and on until one is stable."""
    deadline = clock.after(_EXPLORED)
    found = explore(objective, islice(starts, _STARTS), deadline)
    if found.agrees:
        return found
    from controllers.synthesis.lmi import find_single_step_gain

    plant = objective.plants[0]
    size = float(np.linalg.norm(plant.B1) * np.linalg.norm(plant.C1)) or 1.0
    gain = find_single_step_gain(plant, max(found.gamma if found.candidates else size, 1e-9 * size), deadline)
    if gain is not None:
        found = found.with_more(explore(objective, [StartingGain(gain, objective.gain(objective.unit))], deadline))
    fruitless = 0
    while 2 * fruitless < found.starts and time.monotonic() < deadline:
        more = explore(objective, islice(starts, _STARTS), deadline)
        fruitless = 0 if more.gamma < found.gamma * _GAINED else fruitless + more.starts
        found = found.with_more(more)
    return found


def _require_hope(plants: Sequence[GeneralisedPlant], max_gain: float, deadline: float) -> None:
    """Raise where the time until the deadline suffices to prove that no permitted gain stabilises the plants."""
    gains = int(plants[0].free.sum())
    if gains <= MOST_GAINS:
        limit = np.full(gains, max_gain)
        proof = prove_no_better(plants, np.inf, -limit, limit, max(deadline - time.monotonic(), 0.0))
        if proof.is_proven:
            raise SynthesisError(
                f"no gain with |gain| <= {max_gain:g} stabilises this plant: proven for all of them (in boxes:"
                f" {proof.boxes})"
            )


def _lowest(
    objective: NormObjective,
    found: Descent,
    starts: Iterator[StartingGain],
    seed: int,
    clock: TimeBudget,
    progress: Progress,
) -> StabilisingGain:
    """Refine the candidates; where starts disagree, improve upon the best, and go on while further starts gain."""
    progress(f"{found.starts} starts, {len(found.candidates)} stabilised, gamma {found.gamma:.6g}")
    best = refine(objective, found.candidates, clock.after(_REFINED))
    deadline, tried, fruitless = clock.after(_IMPROVED), found.starts, 0
    while not found.agrees and 2 * fruitless < tried and time.monotonic() < deadline:
        if not fruitless:
            progress(f"gamma {best.gamma:.6g}, looking about it")
            best = improve(objective, best, seed, deadline)
        progress(f"gamma {best.gamma:.6g}, further starts")
        more = explore(objective, islice(starts, _STARTS), deadline)
        lower = refine(objective, [best, *more.candidates], deadline)
        fruitless = 0 if lower.gamma < best.gamma * _GAINED else fruitless + more.starts
        tried, best = tried + more.starts, lower
    progress(f"gamma {best.gamma:.6g}")
    return best


# Relative to the largest singular value, in scaled coordinates: some decades above rounding, far below any real path.
_RANK_TOLERANCE = 1e-10
# A fixed mode moves by rounding alone, which for a double eigenvalue is the root of machine precision.
_FIXED_TOLERANCE = 1e-7


def require_stabilisable(scaled: ScaledPlant) -> None:
    """Return quietly where no mode forbids stabilisation: the tests of Popov, Belevitch and Hautus.

    A mode s of A with Re s >= 0 stays where it is, whatever the gain, if rank [A - s I, B2] < n (u does not reach it)
    or rank [A - s I; C2] < n (y does not see it). With a structured gain it may stay although both ranks are full.

    Raises:
        SynthesisError: an unstable or marginal mode cannot be moved; the sentence names it and says why.
    """
    plant = scaled.plant
    modes = np.linalg.eigvals(plant.A)
    for mode in modes[modes.real >= -_RANK_TOLERANCE]:
        shifted = plant.A - mode * np.eye(plant.order)
        if _loses_rank(np.hstack([shifted, plant.B2])):
            raise _fixed(mode * scaled.rate, "is not reached by the control input (not stabilisable)")
        if _loses_rank(np.vstack([shifted, plant.C2]).T):
            raise _fixed(mode * scaled.rate, "is not seen by the measurement (not detectable)")
        if not plant.free.all() and _stays(plant, mode):
            raise _fixed(mode * scaled.rate, "is moved by no gain of this structure (a fixed mode)")


def _loses_rank(wide: NDArray[np.complex128]) -> bool:
    values = np.linalg.svd(wide, compute_uv=False)
    return bool(values[-1] <= _RANK_TOLERANCE * values[0])


def _stays(plant: GeneralisedPlant, mode: complex) -> bool:
    """Whether three random gains of the structure all leave an eigenvalue at `mode`."""
    # A mode that some gain moves is moved by almost every gain; three rule out an accident.
    random = np.random.default_rng(0)
    loops = [plant.close(random.standard_normal(plant.free.shape) * plant.free) for _ in range(3)]
    distances = [np.abs(loop.poles - mode).min() for loop in loops]
    return bool(max(distances) <= _FIXED_TOLERANCE * max(1.0, abs(mode)))


def _fixed(mode: complex, reason: str) -> SynthesisError:
    where = f"{mode.real:.4g}" if abs(mode.imag) < 1e-12 else f"{mode.real:.4g} +- {abs(mode.imag):.4g}j"
    return SynthesisError(f"no gain can stabilise this plant: its mode {where} 1/s {reason}")
