"""What a damper can do at a speed: least and largest dissipative force, between straight lines."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.clairvoyant.recursion import ForceBand
from seatsim.scenario.scenario import DamperChoice
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.simulation.damper_bench import sine_test

TOP = 1.5
"""m/s; speed up to which the lines hold."""
SPEEDS = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.2, TOP])
CURRENTS, _SLOPES = 9, 201  # grids of the current and of the strip's slope, which is found to half a percent
_STROKE, _FASTEST = 0.02, 2.0  # m and Hz: friction has its full size, and internal flows settle


class DamperEnvelope(NamedTuple):
    """Lines that hold every force of the damper between them (`outer`), and lines between which it has all (`inner`).

    They are about the same for a damper whose steady force is a viscous and a friction part.
    """

    outer: ForceBand
    inner: ForceBand


def fit_envelope(damper: DamperChoice, max_current: float, temperature: float) -> DamperEnvelope:
    """Return the lines of a damper's steady force, at 0 to `max_current` A and a temperature in degC.

    The steady force at a speed is that of a sine test at its peak velocity, either way, where hysteresis is saturated
    and elastic parts are without force. The lines hold to TOP m/s.

    Raises:
        InputError: the damper is not dissipative there, or has no force to choose from.
    """
    currents = np.linspace(0, max_current, CURRENTS)
    forces = np.array([[_measure_steady_force(damper, v, i, temperature) for i in currents] for v in SPEEDS])
    least, most = forces.min(axis=1), forces.max(axis=1)
    driving = (least < 0).any(axis=1)
    if driving.any():
        raise InputError(
            f"the damper drives instead of damping at {SPEEDS[driving][0]:g} m/s (an offset of its force?); the bracket"
            " is of dissipative dampers"
        )
    speeds = SPEEDS[:, None]
    c = max(0.0, min(float(np.polyfit(SPEEDS, least.mean(axis=1), 1)[0]), float((least / speeds).min())))
    b = max(0.0, float(np.polyfit(SPEEDS, most.mean(axis=1), 1)[0]))
    weakest, strongest = least - c * speeds, most - b * speeds
    inner = ForceBand(c, float(weakest.max()), b, float(strongest.min()))
    if inner.a <= inner.f or inner.a + inner.b * TOP <= inner.f + inner.c * TOP:
        raise InputError("the damper's forces at no and at full current do not leave a straight band between them")
    # Of all strips that hold the forces, the narrowest: a wide one would loosen the bound at every speed.
    a, slope = min((_find_half_width(least, most, slope), slope) for slope in np.linspace(0, b, _SLOPES))
    return DamperEnvelope(ForceBand(c, float(weakest.min()), float(slope), a), inner)


def _find_half_width(least: Array, most: Array, slope: float) -> float:
    """Return the least `a` with `abs(F - slope w) <= a` for all forces: the bound's third multiplier is of a strip."""
    middle = slope * SPEEDS[:, None]
    return float(max((most - middle).max(), (middle - least).max()))


def _measure_steady_force(damper: DamperChoice, speed: float, current: float, temperature: float) -> Array:
    """Return the resisting force in N while extending and while compressing."""
    stroke = max(_STROKE, speed / (2 * np.pi * _FASTEST))
    test = sine_test(damper.record, stroke, speed / (2 * np.pi * stroke), current, temperature, damper.factors)
    return np.array([test.force[0], -test.force[len(test.force) // 2]])
