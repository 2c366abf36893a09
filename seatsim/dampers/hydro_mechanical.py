"""Hydro-mechanical damper: chambers that give, and a gap with inertia, resistance and a yield pressure."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.dampers.base import damper
from seatsim.dampers.pieces import UTFSM, CurrentLaw, cubic
from seatsim.dampers.pieces_series import SETTLING
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param


@damper(
    "hydro_mechanical",
    source="Hong, Choi, Choi and Wereley 2005, J. Sound Vib. 285:1180; form vaguely recalled, read by us as lumped"
    f" hydraulics, no parameter set found; {UTFSM}",
    initial=(0.0, 0.0),
    state="V, volume in m^3 that the chambers give; Q, flow in m^3/s through the gap",
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="reading",
    fixed=("A",),
    smooth=True,
)
class HydroMechanical(NamedTuple):
    """Piston of area A between chambers of compliance C, joined by a gap with inertance L and resistance R.

        V' = A v - Q,   p = V / C,   F = A p + k_g x + fs sgn(v) + f0
        L Q' = p - R(I) Q - P_y(I) tanh(Q / Q_r)

    p is the difference of the chambers' pressures. The form is vaguely recalled, this reading ours. For a flat gap
    of width w, height h and length l, R = 12 mu l / (w h^3), P_y = 2 to 3 l tau_y / h, L = rho l / (w h). Q_r
    regularises the sign of the yield pressure. To keep the flow from settling faster than tau =
    `pieces_series.SETTLING`, L counts as L + tau d(R Q + P_y tanh)/dQ (ours): an inertance that depends on the flow
    still stores what it takes, so the model stays passive, and motion slow against tau does not feel it. L scales
    with the viscous factor of the temperature (ours), so that three equal factors scale the whole force. The
    seal's friction fs is set-valued; k_g is the accumulator's. R and P_y are cubic laws, held beyond `law_end`.

    The current acts through the flow, so that the force at a given state does not depend on it: an inverse needs
    another model to assume. A is geometry, which the force does not tell from the other parameters. The
    defaults are derived by us (see `pieces.UTFSM`), with A, C, L and fs chosen; rms error 22, 40, 71, 95,
    136 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s, 1 A and 20 Hz. Temperature scales R and L (viscous), 1/C
    and k_g (elastic), P_y and fs (yield).
    """

    R: Annotated[CurrentLaw, param("Pa s/m^3", "resistance R(I) of the gap")] = (8.68e8, 3.03e9, 6.71e9, -5.23e9)
    P_y: Annotated[CurrentLaw, param("Pa", "yield pressure P_y(I)")] = (1.31e5, 6.2e5, 1.266e6, -8.69e5)
    A: Annotated[float, param("m^2", "area A of the piston, less the rod's", low=1e-5, high=1e-2)] = 9.4e-4
    C: Annotated[float, param("m^3/Pa", "compliance C of the chambers", low=1e-15, high=1e-10)] = 2.0e-13
    L: Annotated[float, param("kg/m^4", "inertance L of the gap", low=1e4, high=1e8)] = 5.0e5
    Q_r: Annotated[float, param("m^3/s", "flow Q_r that regularises the sign", low=1e-7, high=1e-3)] = 7.8e-6
    k_g: Annotated[float, param("N/m", "stiffness of the gas accumulator", low=0, high=1e5)] = 1300.0
    fs: Annotated[float, param("N", "friction of the seal", low=0, high=200)] = 5.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction of the seal."""
        return (self.A * z[0] / self.C + self.k_g * x) * scaling.stiffness + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the seal's set-valued friction in N."""
        return self.fs * scaling.yield_force

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (V', Q')."""
        held, flow = min(i, self.law_end), z[1]
        resistance, yielding = cubic(self.R, held) * scaling.viscous, cubic(self.P_y, held) * scaling.yield_force
        sign = math.tanh(flow / self.Q_r)
        slope = resistance + yielding * (1.0 - sign * sign) / self.Q_r
        driven = z[0] / self.C * scaling.stiffness - resistance * flow - yielding * sign
        return (self.A * v - flow, driven / (self.L * scaling.viscous + SETTLING * slope))
