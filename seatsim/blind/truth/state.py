"""The parameters of the true rig, and the places in its state vector and memory.

Motion is relative: `x = zs - z0` of the suspension, `y = zc - zs` of the cushion.

numba keeps compiled code beside each source and looks only at that file's date: after an edit of a function that is
called from another module, delete the `__pycache__` of this package.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol, TypeVar

import numba
import numpy as np

from seatsim.schema.fields import read_packaged


class RigParameters(Protocol):
    """All parameters of one run, by the names of `parameters.yaml`, which has their defaults and units.

    Compiled functions see them as a record with a 64-bit float for each.
    """

    def __getattr__(self, name: str) -> float:
        """Return a parameter."""


_DEFAULTS = read_packaged(Path(__file__).with_name("parameters.yaml"), dict[str, float])
_RECORD = np.dtype([(name, np.float64) for name in _DEFAULTS])
"""The layout in which compiled functions see `RigParameters`."""


def parameter_record(values: Mapping[str, float]) -> np.void:
    """Return the record for the given parameters; those not given keep their default, so their departure is off.

    Raises:
        ValueError: there is no parameter of a given name.
    """
    record: np.void = np.array([tuple((_DEFAULTS | dict(values)).values())], dtype=_RECORD)[0]
    return record


(
    X,  # m
    V,  # m/s, x'
    Y,  # m
    W,  # m/s, y'
    CURRENT,  # A, in the winding
    CURRENT_2,  # second state of the coil (A, or A/s for a ringing regulator)
    Z,  # hysteretic variable of Bouc-Wen
    FRICTION,  # linkage friction over its sliding force
    SEAL,  # seal friction over its sliding force
    T_FLUID,  # degC
    T_HOUSING,  # degC
    T_THERMOMETER,  # degC
    BODY,  # m, inner body against the seat
    BODY_V,  # m/s
    BODY2,  # m, second inner body
    BODY2_V,  # m/s
    ZENER,  # m, spring of the memory foam
    COVER,  # friction of the cover over its sliding force
    BUSHING,  # m, spring of the Maxwell bushing
    CREEP,  # m, crept part of the spring's deflection
    BASE,  # m, base against the floor
    BASE_V,  # m/s
    PREYIELD,  # late yield variable, or late speed in m/s
    MAGNETISATION,  # A, slow part of the field
    SAG,  # A, mean current that makes the supply sag
    MOUNT,  # m, stretch of the damper's mount
) = range(26)
STATES = 26

(
    CAVITY_VOLUME,  # m of stroke that the cavity has opened
    RELAYS_MEAN,  # A, mean of the hysteresis relays
    DROPOUT_LEFT,  # s, that the present dropout goes on
    V_FRAME,  # m/s, absolute, as a controller would integrate it
    V_DRIVER,  # m/s, absolute
    V_PISTON,  # m/s, last solution of the damper in series with its mount
) = range(6)
MEMORIES = 6
RELAYS = 40
"""Relays of the discrete Preisach model; with 40 the steps of the field (1/40 of its range) are below the noise."""


F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile a function and keep the result on disk.

    Plain IEEE arithmetic, without the reordering that the kernel under test allows itself.
    """
    done: F = numba.njit(cache=True)(function)
    return done


FASTEST = 15000.0
"""Bound on the rate of a bristle, 1/s: 1.5 per step of 0.1 ms, inside the stability limit of Runge-Kutta 4 (2.78)."""
MICRO_DAMPING = 0.001
"""Damping of the bristles, s: keeps a sticking friction from ringing; it acts below the Stribeck speed only."""


@compiled
def bristle_rate(deflection: float, v: float, length: float, stribeck: float, speed: float) -> float:
    """Return the rate of the bristle `s`, in shares of the sliding force, 1/s.

    `s' = |v| / length (sign v - s / G(v))` with `G(v) = 1 + (stribeck - 1) exp(-(v / speed)^2)`.
    """
    level = 1.0 + (stribeck - 1.0) * math.exp(-((v / speed) ** 2))
    rate = min(abs(v) / length, FASTEST)
    return rate * ((1.0 if v > 0.0 else -1.0) - deflection / level)
