"""From plants to a verified, certified design: scale, check, search, verify, certify, bound.

A seat's gain that was found before is kept beside the compiled runs, since a search takes seconds: under the sources of
the synthesis and the matrices of its plants, so that a change of either is searched anew. Its norm and the proof of it
are not kept: they are worked out whenever it is used.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from controllers.synthesis.design import Design, verify
from controllers.synthesis.norm import build_frequency_grid, frequency_response
from controllers.synthesis.plant import MATRICES, GeneralisedPlant, LinearSystem
from controllers.synthesis.search import Progress, TimeBudget, search
from seatsim.compilation.cached import find_folder
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, SeatsimError
from seatsim.schema.files import write_whole

if TYPE_CHECKING:
    import control

_SOURCES = b"".join(file.read_bytes() for file in sorted(Path(__file__).parent.glob("*.py")))
"""Sources of the synthesis, as they are when it is loaded."""


def find_kept(plants: Sequence[GeneralisedPlant], find: Callable[[], Array]) -> Array:
    """Return the gain (nu, ny) that `find` found for these plants before, or finds now.

    A file that is damaged counts as none; where the cache cannot be written, nothing is kept.
    """
    folder = find_folder("gains")
    if folder is None:
        return find()
    state = hashlib.sha256(_SOURCES)
    for plant in plants:
        for matrix in (*(getattr(plant, name) for name in MATRICES), plant.free):
            state.update(repr(matrix.shape).encode() + matrix.tobytes())
    file = folder / f"{state.hexdigest()}.json"
    try:
        kept = np.array(json.loads(file.read_bytes()), dtype=np.float64)
        if kept.shape == plants[0].free.shape and np.isfinite(kept).all():
            return kept
    except (OSError, ValueError, TypeError):
        pass
    gain = find()
    with suppress(SeatsimError):
        write_whole(file, lambda part: part.write_text(json.dumps(gain.tolist())))
    return gain


_MAX_GAIN = 1e6
"""Largest magnitude of an entry of the gain where none is stated."""
_TIME_BUDGET = 60.0
"""Seconds of a search where none are stated."""
SEAT_TIME_BUDGET = 900.0
"""Seconds in which the search for a seat's gain converges on a slow computer too, so that all find the same gain."""


def synthesise(
    A: GeneralisedPlant | Sequence[GeneralisedPlant] | control.StateSpace | ArrayLike,
    B1: ArrayLike | None = None,
    B2: ArrayLike | None = None,
    C1: ArrayLike | None = None,
    C2: ArrayLike | None = None,
    D11: ArrayLike | None = None,
    D12: ArrayLike | None = None,
    D21: ArrayLike | None = None,
    *,
    split: tuple[int, int] | None = None,
    max_gain: float = _MAX_GAIN,
    order: int = 0,
    time_budget: float = _TIME_BUDGET,
    seed: int = 0,
    progress: Progress = lambda text: None,
) -> Design:
    """Find the static output feedback `u = gain @ y` with the smallest H-infinity norm from w to z.

    The plant is given by its eight matrices (shapes: `GeneralisedPlant`), as a `GeneralisedPlant` (which may also keep
    gains at zero), or as a `control.StateSpace` with inputs [w; u], outputs [z; y] and `split = (nw, nz)`. Of several
    plants (a sequence) with the same controls and measurements, the one gain minimises the worst norm.
    `max_gain` bounds every |gain_ij| in the user's units: many infima lie at infinite gain, so quote gamma with it.
    With an `order` k of 1 to 4 the controller has as many states, x_K' = A_K x_K + B_K y, u = C_K x_K + D_K y. The gain
    is then [[D_K, C_K], [B_K, A_K]], (nu + k, ny + k), bounded likewise, and `Design.controller` the state space.
    `time_budget` in s: the search stops there, a computation under way may take a few seconds more. The same seed
    gives the same design, unless time runs out. `progress` is called with a line on what the search does.
    The problem is not convex: the answer is the best of several starts, a local optimum with a certificate of its own
    gamma.

    Raises:
        InputError: a matrix, the split or an option is wrong.
        SynthesisError: no gain can stabilise the plants, or none was found.
    """
    begin = time.monotonic()
    plants = _collect_plants(A, (B1, B2, C1, C2, D11, D12, D21), split)
    for name, value in (("max_gain", max_gain), ("time_budget", time_budget)):
        if not 0 < value < np.inf:
            raise InputError(f"{name} is {value}; a finite number above 0 is wanted")
    if order not in range(5):
        raise InputError(f"order is {order!r}; a controller of order 0 (a static gain) to 4 is wanted")
    plants = [plant.with_controller_states(order) for plant in plants] if order else plants
    gain = search(plants, max_gain, seed, TimeBudget(begin, time_budget), progress)
    loops = tuple(verify(plant, gain, order) for plant in plants)
    design = Design(gain, float(max_gain), 0.0, loops, order=order)
    progress("the bound of any controller")
    bound = max(compute_pointwise_bound(plant, gain) for plant in plants)
    proof, deadline = design.certificate, begin + time_budget
    # In the coordinates of the certificate the LMI is well scaled.
    if proof is not None and time.monotonic() < deadline:
        from controllers.synthesis.lmi import compute_full_order_bound

        bound = max(bound, compute_full_order_bound(design.worst.plant, proof.factor, proof.gamma, deadline))
    return replace(design, lower_bound=min(bound, design.gamma))


def find_gain(plants: Sequence[GeneralisedPlant]) -> Array:
    """Return the gain that `synthesise` finds for plants within `SEAT_TIME_BUDGET` s, without certificate and bound.

    A gain that was found before is taken from the cache.
    """
    clock = TimeBudget(time.monotonic(), SEAT_TIME_BUDGET)
    return find_kept(plants, lambda: search(plants, _MAX_GAIN, 0, clock, lambda text: None))


def _collect_plants(
    first: GeneralisedPlant | Sequence[GeneralisedPlant] | control.StateSpace | ArrayLike,
    others: Sequence[ArrayLike | None],
    split: tuple[int, int] | None,
) -> list[GeneralisedPlant]:
    """Return the plants, whichever way they were given."""
    if isinstance(first, GeneralisedPlant):
        return [first]
    if isinstance(first, Sequence) and first and all(isinstance(plant, GeneralisedPlant) for plant in first):
        plants = list(cast("Sequence[GeneralisedPlant]", first))
        for i, plant in enumerate(plants):
            if not np.array_equal(plant.free, plants[0].free):
                raise InputError(
                    f"plant {i} has {plant.control_count} controls, {plant.measured_count} measurements and its own "
                    f"structure; one gain for all wants those of plant 0: {plants[0].free.astype(int).tolist()}"
                )
        return plants
    if hasattr(first, "dt"):  # as a state space of control or scipy has, in continuous time too
        if split is None:
            raise InputError("a state space needs its split: split=(disturbance inputs, performance outputs)")
        return [GeneralisedPlant.from_state_space(first, *split)]
    missing = [name for name, part in zip(MATRICES[1:], others, strict=True) if part is None]
    if missing:
        raise InputError(f"the plant lacks {', '.join(missing)}; give all of {', '.join(MATRICES)}, or a plant object")
    return [GeneralisedPlant.from_matrices([cast(ArrayLike, first), *(part for part in others if part is not None)])]


Response = NDArray[np.complex128]


def compute_pointwise_bound(plant: GeneralisedPlant, stabilising: Array) -> float:
    """Return a bound that no controller beats, whatever its order, from the frequency response alone.

    With T the closed loop of any one stabilising gain (nu, ny), every other controller gives T + T12 Q T21 at each
    frequency, so that

        gamma >= sup over omega of max(sigma_max(N'T), sigma_max(T M)),  N'T12 = 0, T21 M = 0, N, M orthonormal.

    Weaker than the full-order LMI bound, but exact to rounding and cheap at any order.
    Source: Parrott's theorem, in Zhou, Doyle & Glover 1996, Robust and Optimal Control, section 2.11.
    """
    loop = plant.close(stabilising)
    omega = build_frequency_grid(loop)
    T = frequency_response(loop, omega)
    from_control = frequency_response(LinearSystem(loop.A, plant.B2, loop.C, plant.D12), omega)
    to_measured = frequency_response(LinearSystem(loop.A, loop.B, plant.C2, plant.D21), omega)
    adjoint = _largest_unreached(to_measured.swapaxes(1, 2).conj(), T.swapaxes(1, 2).conj())
    return max(_largest_unreached(from_control, T), adjoint)


def _largest_unreached(path: Response, T: Response) -> float:
    """Largest singular value, over all frequencies, of what `path` (m, nz, nu) does not reach of T."""
    reached = path.shape[2]
    # With as many inputs as outputs nothing is out of reach.
    if path.shape[1] <= reached:
        return 0.0
    basis = np.linalg.svd(path)[0][:, :, reached:]
    return float(np.linalg.svd(basis.swapaxes(1, 2).conj() @ T, compute_uv=False).max())
