"""Phase-transition damper: an order parameter in a Landau potential, driven by the velocity."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.dampers.base import damper
from seatsim.dampers.pieces import UTFSM, CurrentLaw, between, cubic
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param

V_REF = 0.1
"""Steady velocity in m/s at which the order parameter is 1, chosen by us: the scale of the damper's speeds."""


@damper(
    "phase_transition",
    source="Wang and Kamath 2006, Smart Mater. Struct. 15:1725, whose equations were not at hand: our reading of its"
    f" idea; {UTFSM}",
    initial=(0.0,),
    state="p, order parameter of the flow",
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="reading",
    smooth=True,
)
class PhaseTransition(NamedTuple):
    """Yield as a phase transition: the flow's order parameter relaxes in a Landau potential.

        F  = c(I) v + fy(I) p + f0
        p' = {v / v_ref - dG/dp} / tau(I),   G = a p^2 / 2 + (1 - a) p^6 / 6,   v_ref = 0.1 m/s

    Steady flow at v_ref has p = 1, of either sign; the smaller a, the closer is p to a sign of v and the slower
    its reversal, which makes the loop. Our reading, physically sound, not the paper's equations: that the order
    parameter of a Landau free energy obeys a differential equation driven by the velocity is all we know of
    them. Two wells (a < 0) are excluded: p would keep its sign at rest and the damper push. Dissipative.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 19 N at 0 A to 108 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous) and fy (yield).
    """

    c: Annotated[CurrentLaw, param("N s/m", "viscous damping c(I)")] = (150.0, 0.0, 0.0, 0.0)
    fy: Annotated[CurrentLaw, param("N", "yield force fy(I)")] = (188.0, 883.0, 1770.0, -1297.0)
    a: Annotated[float, param("-", "share of the quadratic term of the potential", low=1e-3, high=1)] = 0.135
    tau0: Annotated[float, param("s", "time of relaxation at zero current", low=1e-4, high=0.1)] = 1e-3
    tau1: Annotated[float, param("s", "the same at law_end", low=2e-4, high=0.2)] = 2.4e-3
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return cubic(self.c, held) * scaling.viscous * v + cubic(self.fy, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (p',)."""
        gradient = z[0] * (self.a + (1.0 - self.a) * z[0] ** 4)
        return ((v / V_REF - gradient) / between(self.tau0, self.tau1, i, self.law_end),)
