"""Bingham dampers: a viscous dashpot beside Coulomb friction."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.dampers.base import damper
from seatsim.dampers.pieces import CurrentLaw, cubic
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param

SET_VALUED_BELOW = 1e-6
"""m/s; a sharper `v_ref` than this is taken as the set-valued sign itself."""


@damper(
    "bingham",
    source="Stanway, Sproston and Stevens 1987, J. Electrostatics 20:167",
    current_order=1,
    complete=True,
    confidence="published",
    fixed=("v_ref",),
)
class Bingham(NamedTuple):
    """Bingham damper with laws linear in the current.

        F = (c_a + c_b i) v + (fc_a + fc_b i) tanh(v / v_ref) + f0

    `v_ref` regularises the sign; 0 means the sign itself, set-valued at rest (`|F - f0| <= fc` at v = 0).
    """

    c_a: Annotated[float, param("N s/m", "viscous damping at zero current", low=0)] = 250.0
    c_b: Annotated[float, param("N s/(m A)", "rise of the viscous damping with current")] = 350.0
    fc_a: Annotated[float, param("N", "yield force at zero current", low=0)] = 45.0
    fc_b: Annotated[float, param("N/A", "rise of the yield force with current")] = 620.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    v_ref: Annotated[float, param("m/s", "speed that regularises the sign", low=0, high=1)] = 0.004

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction where that is set-valued."""
        smooth = (self.c_a + self.c_b * i) * scaling.viscous * v + self.f0
        if self.v_ref < SET_VALUED_BELOW:
            return smooth
        return smooth + (self.fc_a + self.fc_b * i) * scaling.yield_force * math.tanh(v / self.v_ref)

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the set-valued friction in N; 0 where the sign is regularised."""
        if self.v_ref < SET_VALUED_BELOW:
            return max(0.0, (self.fc_a + self.fc_b * i) * scaling.yield_force)
        return 0.0


@damper(
    "original_bingham",
    source="Stanway et al. 1987 with the current laws of Braz-Cesar and Barros 2012 eqs 4.1-4.2, whose"
    " printed numbers are lost: defaults fitted by us to their modified Bouc-Wen model of the RD-1005-3",
    max_speed=0.13,
    max_current=1.0,
    confidence="published",
)
class OriginalBingham(NamedTuple):
    """Bingham damper with cubic current laws and a set-valued yield force: `F = c0(I) v + fc(I) sgn(v) + f0`.

    Defaults are a surrogate of the RD-1005-3 (derived, not published): fitted over 0.5-2 Hz, 2-10 mm and 0-1
    A, rms 20-279 N; `f0` is the paper's 40 N, off by default because the seat's rest position absorbs it.
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (940.0, 13280.0, 20350.0, -20040.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (35.7, 390.0, 675.0, -609.3)
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the smooth part of F in N."""
        return cubic(self.c0, i) * scaling.viscous * v + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the set-valued yield force in N."""
        return max(0.0, cubic(self.fc, i) * scaling.yield_force)
