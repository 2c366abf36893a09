"""Bingham dampers with springs in series: modified, and after Gamota and Filisko.

The force is that of a spring, which the current reaches only through the state: an inverse does better with another
model to assume.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.dampers.base import damper
from seatsim.dampers.pieces import UTFSM, CurrentLaw, cubic
from seatsim.dampers.pieces_series import slip
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param


@damper(
    "modified_bingham",
    source=f"Wang and Liao 2011, Smart Mater. Struct. 20:023001, eq 13, without parameters; {UTFSM}",
    initial=(0.0,),
    state="e = x - x1, deflection in m of the series spring",
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="published",
)
class ModifiedBingham(NamedTuple):
    """Bingham element (displacement x1) in series with a spring k1.

        F = c0(I) x1' + fc(I) sgn(x1') + f0 = k1(I) (x - x1) + f0

    The form is as printed. Solved for the state by us: with q = k1 e, x1' = 0 for |q| <= fc and (q - fc sgn q) /
    c0 beyond, e' = v - x1', which is continuous and holds the friction at rest without a set-valued sign. k1 =
    k_a + k_b I; c0 and fc are cubic laws, held beyond `law_end`. The defaults are derived by us (see
    `pieces.UTFSM`); rms error 29, 69, 117, 150, 190 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s and
    1 A. Temperature scales c0 (viscous), k1 (elastic) and fc (yield).
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (1163.0, 5447.0, 8467.0, -7215.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (101.6, 401.9, 1014.0, -647.2)
    k_a: Annotated[float, param("N/m", "stiffness k1 at zero current", low=1e4, high=1e8)] = 2.2e6
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness k1 with current", low=0, high=1e8)] = 5.0e6
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return (self.k_a + self.k_b * held) * scaling.stiffness * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e',)."""
        held = min(i, self.law_end)
        q = (self.k_a + self.k_b * held) * scaling.stiffness * z[0]
        return (v - slip(q, cubic(self.fc, held) * scaling.yield_force, cubic(self.c0, held) * scaling.viscous),)


@damper(
    "gamota_filisko",
    source=f"Gamota and Filisko 1991, J. Rheology 35:399; form recalled, no parameter set found; {UTFSM}",
    initial=(0.0, 0.0),
    state="e2 = x - x2, deflection in m of the outer spring; e1 = x2 - x1, deflection in m of the inner solid",
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="recalled",
)
class GamotaFilisko(NamedTuple):
    """Bingham element (x1) in series with a standard linear solid: spring k1 beside dashpot c1 (x2 - x1), spring k2.

        |F - f0| > fc:   F = c0(I) x1' + fc(I) sgn(x1') + f0
        always:          F = k1 (x2 - x1) + c1 (x2' - x1') + f0 = k2(I) (x - x2) + f0
        |F - f0| <= fc:  x1' = 0

    The form is recalled, the yield criterion read without the offset. Solved for the states by us: q = k2 e2, x1'
    = 0 for |q| <= fc and (q - fc sgn q) / c0 beyond, e1' = (q - k1 e1) / c1, e2' = v - x1' - e1'. k2 = k2_a +
    k2_b I; c0 and fc are cubic laws, held beyond `law_end`. The defaults are derived by us (see
    `pieces.UTFSM`); rms error 29, 65, 98, 106, 141 N at 0, 0.25, 0.5, 0.75, 1 A; these data leave next to
    no k1, so that the solid creeps. Valid to 0.13 m/s and 1 A. Temperature scales c0 and c1 (viscous), k1 and k2
    (elastic) and fc (yield).
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I) past yield")] = (1146.0, 5505.0, 3984.0, -5248.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (105.2, 388.2, 1551.0, -915.3)
    k1: Annotated[float, param("N/m", "stiffness k1 of the inner spring", low=1e2, high=1e8)] = 1.0e4
    c1: Annotated[float, param("N s/m", "damping c1 beside the inner spring", low=1e3, high=1e7)] = 8.4e4
    k2_a: Annotated[float, param("N/m", "stiffness k2 at zero current", low=1e4, high=1e8)] = 1.6e6
    k2_b: Annotated[float, param("N/(m A)", "rise of the stiffness k2 with current", low=0, high=1e8)] = 4.0e6
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return (self.k2_a + self.k2_b * held) * scaling.stiffness * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (e2', e1')."""
        held = min(i, self.law_end)
        q = (self.k2_a + self.k2_b * held) * scaling.stiffness * z[0]
        flow = slip(q, cubic(self.fc, held) * scaling.yield_force, cubic(self.c0, held) * scaling.viscous)
        creep = (q - self.k1 * scaling.stiffness * z[1]) / (self.c1 * scaling.viscous)
        return (v - flow - creep, creep)
