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


X, V, Y, W = range(4)
"""m and m/s: x, x', y and y'."""
CURRENT, CURRENT_2, Z, FRICTION, SEAL = range(4, 9)
"""A in the winding; second state of the coil (A, or A/s for a ringing regulator); hysteretic variable of Bouc-Wen;
linkage friction and seal friction over their sliding forces."""
T_FLUID, T_HOUSING, T_THERMOMETER = range(9, 12)
"""degC."""
BODY, BODY_V, BODY2, BODY2_V = range(12, 16)
"""m and m/s: an inner body against the seat, and a second one."""
ZENER, COVER, BUSHING, CREEP = range(16, 20)
"""m of the spring of the memory foam; friction of the cover over its sliding force; m of the spring of the Maxwell
bushing, and crept part of the spring's deflection."""
BASE, BASE_V = range(20, 22)
"""m and m/s: base against the floor."""
PREYIELD, MAGNETISATION, SAG, MOUNT = range(22, 26)
"""Late yield variable, or late speed in m/s; A, slow part of the field; A, mean current that makes the supply sag; m,
stretch of the damper's mount."""
STATES = 26

CAVITY_VOLUME, RELAYS_MEAN, DROPOUT_LEFT = range(3)
"""m of stroke that the cavity has opened; A, mean of the hysteresis relays; s, that the present dropout goes on."""
V_FRAME, V_DRIVER, V_PISTON = range(3, 6)
"""m/s: absolute of frame and driver, as a controller would integrate them; last solution of the damper in series with
its mount."""
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
