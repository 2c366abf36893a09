"""Bouc-Wen dampers: simple, and modified after Spencer."""

from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, damper, param
from seatsim.dampers.pieces import CurrentLaw, bouc_wen_rate, cubic

_HYSTERESIS = "z, the hysteretic displacement"


@damper("bouc_wen", initial=(0.0,), state=_HYSTERESIS, current_order=1, complete=True, fixed=("A", "x0"))
class BoucWen(NamedTuple):
    """Simple Bouc-Wen damper with laws linear in the current.

        F  = (c_a + c_b i) v + k0 (x - x0) + (alpha_a + alpha_b i) z + f0
        z' = A v - beta v |z|^n - gamma |v| z |z|^(n-1),   |z| <= (A / (beta + gamma))^(1/n)

    The hysteretic variable z has no unit of its own: A sets its scale.

    Source: Wen 1976; Spencer et al. 1997, J. Eng. Mech. 123:230
    """

    c_a: Annotated[float, param("N s/m", "viscous damping at zero current", low=0)] = 250.0
    c_b: Annotated[float, param("N s/(m A)", "rise of the viscous damping with current")] = 350.0
    alpha_a: Annotated[float, param("N/[z]", "hysteretic force at zero current", low=0)] = 45.0
    alpha_b: Annotated[float, param("N/([z] A)", "rise of the hysteretic force with current")] = 620.0
    k0: Annotated[float, param("N/m", "stiffness, of the gas accumulator")] = 0.0
    x0: Annotated[float, param("m", "displacement at which the stiffness is without force")] = 0.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    A: Annotated[float, param("[z]/m", "slope of the hysteresis", above=0)] = 2000.0
    beta: Annotated[float, param("[z]^(1-n)/m", "shape: coefficient of v |z|^n")] = 1000.0
    gamma: Annotated[float, param("[z]^(1-n)/m", "shape: coefficient of |v| z |z|^(n-1)")] = 1000.0
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 2.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        viscous = (self.c_a + self.c_b * i) * scaling.viscous * v
        elastic = self.k0 * scaling.stiffness * (x - self.x0)
        return viscous + elastic + (self.alpha_a + self.alpha_b * i) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (z',)."""
        return (bouc_wen_rate(self.A, self.beta, self.gamma, self.n, v, z[0]),)


@damper("simple_bouc_wen", initial=(0.0,), state=_HYSTERESIS, max_speed=0.13, max_current=1.0, fixed=("A",))
class SimpleBoucWen(NamedTuple):
    """Simple Bouc-Wen damper of the RD-1005-3 with cubic current laws.

        F  = c0(I) v + k0 x + alpha(I) z + f0
        z' = A v - beta v |z|^n - gamma |v| z |z|^(n-1)

    z in m. alpha and c0 are a surrogate (derived, not published): fitted over 0.5-2 Hz, 2-10 mm, 0-1 A, rms
    14-166 N.

    Source: Braz-Cesar and Barros 2012, eqs 2.2-2.3 (A, beta, gamma, k0, n as printed); its current laws
    4.3-4.4 are lost: alpha and c0 fitted by us to its modified Bouc-Wen model of the RD-1005-3
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (855.0, 11200.0, 18970.0, -18690.0)
    alpha: Annotated[CurrentLaw, param("N/m", "hysteretic stiffness alpha(I)")] = (
        9350.0,
        116600.0,
        173900.0,
        -158300.0,
    )
    k0: Annotated[float, param("N/m", "stiffness")] = 1984.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    A: Annotated[float, param("-", "slope of the hysteresis", above=0)] = 30.852
    beta: Annotated[float, param("1/m^2", "shape: coefficient of v |z|^n")] = 0.081e6
    gamma: Annotated[float, param("1/m^2", "shape: coefficient of |v| z |z|^(n-1)")] = 1.507e6
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 2.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        viscous = cubic(self.c0, i) * scaling.viscous * v
        return viscous + self.k0 * scaling.stiffness * x + cubic(self.alpha, i) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (z',)."""
        return (bouc_wen_rate(self.A, self.beta, self.gamma, self.n, v, z[0]),)


@damper(
    "modified_bouc_wen",
    initial=(0.0, 0.0),
    state="y, displacement behind the series dashpot; z, hysteretic displacement",
    max_speed=0.13,
    max_current=1.0,
    fixed=("A", "x0"),
)
class ModifiedBoucWen(NamedTuple):
    """Modified Bouc-Wen damper: a Bouc-Wen element in series with a dashpot c1.

        y' = (alpha(I) z + c0(I) v + k0 (x - y)) / (c0(I) + c1(I))
        z' = A r - beta r |z|^n - gamma |r| z |z|^(n-1),   r = v - y'
        F  = c1(I) y' + k1 (x - x0) + f0

    Defaults: RD-1005-3, cubic laws as published (converted from N, mm, s). gamma = 0.103 1/mm^2 goes with
    |r|, beta = 3.044 1/mm^2 with r. alpha peaks at 0.91 A and is negative at 1.5 A: the laws hold at 1 A
    beyond 1 A. The published offset f0 = 40 N is off by default because the seat's rest position absorbs it.

    Source: Spencer et al. 1997, J. Eng. Mech. 123:230; RD-1005-3 set of Braz-Cesar and Barros 2012, eqs
    4.5-4.7
    """

    c0: Annotated[CurrentLaw, param("N s/m", "damping c0(I) of the inner dashpot")] = (
        590.0,
        11020.0,
        10510.0,
        -11730.0,
    )
    c1: Annotated[CurrentLaw, param("N s/m", "damping c1(I) of the series dashpot")] = (
        4730.0,
        64570.0,
        57030.0,
        -54400.0,
    )
    alpha: Annotated[CurrentLaw, param("N/m", "hysteretic stiffness alpha(I)")] = (
        38240.0,
        412520.0,
        905140.0,
        -826670.0,
    )
    k0: Annotated[float, param("N/m", "stiffness of the inner spring")] = 1121.0
    k1: Annotated[float, param("N/m", "stiffness of the accumulator")] = 0.0
    x0: Annotated[float, param("m", "displacement at which the accumulator is without force")] = 0.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    A: Annotated[float, param("-", "slope of the hysteresis", above=0)] = 10.013
    beta: Annotated[float, param("1/m^2", "shape: coefficient of r |z|^n")] = 3.044e6
    gamma: Annotated[float, param("1/m^2", "shape: coefficient of |r| z |z|^(n-1)")] = 0.103e6
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 2.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        c0, c1 = cubic(self.c0, held) * scaling.viscous, cubic(self.c1, held) * scaling.viscous
        inner = cubic(self.alpha, held) * scaling.yield_force * z[1] + self.k0 * scaling.stiffness * (x - z[0])
        return c1 * (inner + c0 * v) / (c0 + c1) + self.k1 * scaling.stiffness * (x - self.x0) + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (y', z')."""
        held = min(i, self.law_end)
        c0, c1 = cubic(self.c0, held) * scaling.viscous, cubic(self.c1, held) * scaling.viscous
        inner = cubic(self.alpha, held) * scaling.yield_force * z[1] + self.k0 * scaling.stiffness * (x - z[0])
        flow = (inner + c0 * v) / (c0 + c1)
        return (flow, bouc_wen_rate(self.A, self.beta, self.gamma, self.n, v - flow, z[1]))
