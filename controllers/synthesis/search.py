"""The search for one gain on one or several plants, on as few of them at a time as decide.

It works in scaled coordinates, since LMIs and searches fail in raw SI units:

    x = diag(states) x~,  u = diag(controls) u~,  y~ = diag(measured) y,  t~ = rate t,
    K = diag(controls) K~ diag(measured)

All factors are powers of two, so that scaling costs no rounding. w and z are left alone: gamma is the same number.
"""

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
from controllers.synthesis.plant import GeneralisedPlant, LinearSystem
from seatsim.schema.arrays import Array
from seatsim.schema.errors import SynthesisError

# Steps are powers of two, so that sweeps end where no factor changes; a guard where they circle.
_SWEEPS = 30


class _ScaledPlant(NamedTuple):
    """A plant in scaled coordinates, and the way back."""

    plant: GeneralisedPlant
    controls: Array
    measured: Array
    rate: float

    def physical_gain(self, gain: Array) -> Array:
        """Gain in the user's units from the gain in scaled coordinates."""
        return self.controls[:, None] * gain * self.measured

    def scaled_gain(self, gain: Array) -> Array:
        """Gain in scaled coordinates from the gain in the user's units."""
        return gain / (self.controls[:, None] * self.measured)


def scale(plant: GeneralisedPlant, like: _ScaledPlant | None = None) -> _ScaledPlant:
    """Balance states against each other, B1 against C1, time against the poles; unit columns in B2, unit rows in C2.

    Units of control, measurement and time are those of `like` where it is given.
    """
    rate = like.rate if like else _power_of_two(_mean_rate(plant.A))
    states = np.ones(plant.order)
    for _ in range(_SWEEPS):
        step = _balancing_step(plant, states, rate)
        states = states * step
        if np.all(step == 1.0):
            break
    states = states * _power_of_two(np.sqrt(_size(plant.B1 / states[:, None] / rate) / _size(plant.C1 * states)))
    controls, measured = (like.controls, like.measured) if like else _input_output(plant, states, rate)
    nw, nz = plant.B1.shape[1], len(plant.C1)
    A, B, C, D = plant.system
    inputs, outputs = np.append(np.ones(nw), controls), np.append(np.ones(nz), measured)[:, None]
    flow, drive = A * states / states[:, None] / rate, B * inputs / states[:, None] / rate
    moved = LinearSystem(flow, drive, C * states * outputs, D * inputs * outputs)
    return _ScaledPlant(GeneralisedPlant.from_system(moved, nw, nz, plant.structure), controls, measured, rate)


def _input_output(plant: GeneralisedPlant, states: Array, rate: float) -> tuple[Array, Array]:
    """Factors that give about unit length to the columns of B2 and the rows of C2."""
    return 1 / _sizes(plant.B2 / states[:, None] / rate), 1 / _sizes((plant.C2 * states).T)


def _balancing_step(plant: GeneralisedPlant, states: Array, rate: float) -> Array:
    """Factors that make the row and the column of every state in [A B; C 0] about equally large (Osborne)."""
    controls, measured = _input_output(plant, states, rate)
    A = np.abs(plant.A - np.diag(np.diag(plant.A))) * states / states[:, None] / rate
    B1, C1 = plant.B1 / states[:, None], plant.C1 * states
    rows = np.hstack([A, B1 / _size(B1), plant.B2 * controls / states[:, None] / rate])
    columns = np.vstack([A, C1 / _size(C1), plant.C2 * states * measured[:, None]])
    r, c = np.linalg.norm(rows, axis=1), np.linalg.norm(columns, axis=0)
    ratio = np.divide(r, c, out=np.ones_like(r), where=(r > 0) & (c > 0))
    # A quarter of the exponent at a time: all states move at once, and full steps would overshoot.
    return np.asarray(np.exp2(np.round(np.log2(ratio) / 4)))


def _mean_rate(A: Array) -> float:
    """Return the geometric mean of the poles' magnitudes in 1/s, without integrators; 1 where there is no other."""
    rates = np.abs(np.linalg.eigvals(A))
    moving = rates[rates > 1e-9 * max(rates.max(), 1e-300)]
    return float(np.exp(np.log(moving).mean())) if moving.size else 1.0


def _size(matrix: Array) -> float:
    return float(np.linalg.norm(matrix)) or 1.0


def _sizes(columns: Array) -> Array:
    norms = np.linalg.norm(columns, axis=0)
    return np.array([_power_of_two(norm) if norm > 0 else 1.0 for norm in norms])


def _power_of_two(value: float) -> float:
    return float(np.exp2(np.round(np.log2(value))))


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


def require_stabilisable(scaled: _ScaledPlant) -> None:
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
