"""Can any gain stabilise the plant? The tests of Popov, Belevitch and Hautus, also for structured gains.

A mode s of A with Re s >= 0 stays where it is, whatever the gain, if rank [A - s I, B2] < n (u does not reach it)
or rank [A - s I; C2] < n (y does not see it). With a structured gain it may stay although both ranks are full.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.scaling import ScaledPlant
from seatsim.schema.errors import SynthesisError

# Relative to the largest singular value, in scaled coordinates: some decades above rounding, far below any real path.
_RANK_TOLERANCE = 1e-10
# A fixed mode moves by rounding alone, which for a double eigenvalue is the root of machine precision.
_FIXED_TOLERANCE = 1e-7


def require_stabilisable(scaled: ScaledPlant) -> None:
    """Return quietly where no mode forbids stabilisation.

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
