"""Arctangent damper: an S-curve of the velocity, shifted to either side by the branch of the loop."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.dampers.base import damper
from seatsim.dampers.pieces import BRANCH_STATE, UTFSM, CurrentLaw, branch, branch_rate, cubic
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param


@damper(
    "weng_arctangent",
    source=f"Weng et al., as eq 12 of Braz-Cesar and Barros 2012; {UTFSM}",
    initial=(0.0,),
    state=BRANCH_STATE,
    centred=True,
    max_speed=0.126,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="published",
    smooth=True,
)
class WengArctangent(NamedTuple):
    """Arctangent S-curve with a hysteresis of constant width in velocity.

        F = c0(I) v + (2/pi) fc(I) arctan{kH [v - vH(I) sgn(v')]} + f0

    The branch -sgn(v') is the smoothed sign of the displacement about its recent mean (`pieces.branch`), the
    same for harmonic motion. The paper prints no parameters. The defaults are derived by us, from
    measurement: one steady cycle each of 2 mm 5 Hz, 5 mm 3 and 4 Hz, 10 mm 2 Hz, 25 mm 0.25 and 0.5 Hz at 0,
    0.25, 0.5, 0.75, 1 A, offset removed; rms error 22, 37, 72, 123, 189 N at these currents, 10 % of the peak
    force over all. Valid to 0.126 m/s and 1 A, at which the laws are held. Temperature scales c0 (viscous)
    and fc (yield).
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (391.3, 2709.0, 0.0, 0.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (168.8, 646.6, 1602.9, -1131.6)
    k_h: Annotated[float, param("s/m", "steepness kH of the S-curve", above=0)] = 141.7
    v_h: Annotated[CurrentLaw, param("m/s", "half width vH(I) of the loop")] = (4.18e-3, 5.43e-3, 0.0, 0.0)
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        angle = math.atan(self.k_h * (v + cubic(self.v_h, held) * branch(z)))
        yielding = cubic(self.fc, held) * scaling.yield_force * 2.0 / math.pi * angle
        return cubic(self.c0, held) * scaling.viscous * v + yielding + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return branch_rate(v, z)
