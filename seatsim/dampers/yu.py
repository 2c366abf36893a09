"""The dampers of Yu et al.: asymmetric and temperature-dependent (2019), and their conventional model (2017)."""

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureFactors, TemperatureScaling, jit, param
from seatsim.dampers.pieces import (
    BRANCH_STATE,
    LinearLaw,
    QuadraticLaw,
    branch,
    branch_damper,
    branch_rate,
    quadratic,
    utfsm_damper,
)

_RISE_TIME = 0.01
"""Time in s in which the envelope of the speed takes up a higher speed."""
_DECAY_TIME = 2.0
"""Time in s in which it forgets a lower one."""


@jit
def envelope_rate(speed: float, envelope: float) -> float:
    """Return the rate of the envelope of the speed in m/s^2: fast to a higher speed, slow to a lower one."""
    return (speed - envelope) / (_RISE_TIME if speed > envelope else _DECAY_TIME)


@utfsm_damper(
    "yu2017",
    initial=(0.0, 0.0),
    state=f"{BRANCH_STATE}; e, envelope of the speed in m/s, for the cycle's peak speed",
    centred=True,
    max_speed=0.126,
    fixed=("c_i2", "d2"),
)
class Yu2017(NamedTuple):
    """Backbone and branch of a symmetric loop, divided and scaled by one height S.

        F = S(vm, I) {(1 - exp(b1 |v|)) / (1 + exp(b2 |v|)) sgn(v) + d1 exp(-(|v| - d2)^2 / d3) sgn(x)}
        S = c1 + c2 / (1 + exp(c3 vm)) + cI1 exp(cI2 I),   b1, b2 < 0

    vm is the peak speed of the cycle, here the causal envelope `e' = (|v| - e) / tau`, tau = 0.01 s where |v|
    > e and 2 s below; sgn(x) is smoothed and taken about the recent mean (`pieces.branch`). S is held at 0 where
    its terms fall below (ours), since a damper of negative height would push. Read otherwise than printed: eq 5 has
    v in the Gaussian, which for d2 != 0 would make the symmetric model asymmetric.

    No parameters are published. The defaults are derived by us, from measurement: one steady cycle each of 2
    mm 5 Hz, 5 mm 3 and 4 Hz, 10 mm 1 and 2 Hz, 25 mm 0.1, 0.25 and 0.5 Hz at 0, 0.25, 0.5, 0.75, 1 A, offset
    removed, with d2 = 0 and cI2 = -0.3 1/A chosen (these data rise almost linearly with current); rms error
    21, 62, 94, 162, 228 N, 12 % of the peak force over all. Valid to 0.126 m/s and 1 A. Temperature scales S
    (yield); nothing here is viscous.

    Source: Yu, Dong and Zhang 2017, Smart Mater. Struct. 26, as eq 5 of Yu et al. 2019 (conventional model)
    """

    c1: Annotated[float, param("N", "height S, constant")] = 5828.0
    c2: Annotated[float, param("N", "height S, part that depends on the peak speed")] = -164.6
    c3: Annotated[float, param("s/m", "height S, rate with the peak speed", low=-1e4, high=1e4)] = -39.0
    c_i1: Annotated[float, param("N", "height S, part that depends on the current")] = -5464.0
    c_i2: Annotated[float, param("1/A", "height S, rate with the current", low=-20, high=20)] = -0.3
    b1: Annotated[float, param("s/m", "backbone, rate in the numerator", high=0)] = -181.3
    b2: Annotated[float, param("s/m", "backbone, rate in the denominator", high=0)] = -26.75
    d1: Annotated[float, param("-", "branch, height over S")] = 0.2279
    d2: Annotated[float, param("m/s", "branch, speed of its largest value")] = 0.0
    d3: Annotated[float, param("m^2/s^2", "branch, squared width", above=0)] = 1.732e-4

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        speed = abs(v)
        # 1 / (1 + exp(q)), written so that it cannot overflow.
        share = 0.5 - 0.5 * math.tanh(0.5 * self.c3 * z[1])
        height = max(0.0, self.c1 + self.c2 * share + self.c_i1 * math.exp(self.c_i2 * i))
        backbone = (1.0 - math.exp(self.b1 * speed)) / (1.0 + math.exp(self.b2 * speed))
        loop = self.d1 * math.exp(-((speed - self.d2) ** 2) / self.d3) * branch(z)
        return height * scaling.yield_force * (math.copysign(backbone, v) + loop)

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w', e')."""
        return (*branch_rate(v, z), envelope_rate(abs(v), z[1]))


_Coefficient = Annotated[float, param("-", "coefficient of a power of u")]
_Three = tuple[_Coefficient, _Coefficient, _Coefficient]
_Four = tuple[_Coefficient, _Coefficient, _Coefficient, _Coefficient]
_Six = tuple[_Coefficient, _Coefficient, _Coefficient, _Coefficient, _Coefficient, _Coefficient]
_Seven = tuple[_Coefficient, _Coefficient, _Coefficient, _Coefficient, _Coefficient, _Coefficient, _Coefficient]


@jit
def rebound(p: _Three, d: _Three, s: float) -> float:
    """Return the backbone P of extension at the scaled speed s >= 0: even powers 0-4 over 2-6."""
    w = s * s
    return (p[0] + w * (p[1] + w * p[2])) / (1.0 + w * (d[0] + w * (d[1] + w * d[2])))


@jit
def compression(n: _Four, d: _Three, s: float) -> float:
    """Return the backbone N of compression at the scaled speed s >= 0: powers 0-3 over 1-3."""
    return (n[0] + s * (n[1] + s * (n[2] + s * n[3]))) / (1.0 + s * (d[0] + s * (d[1] + s * d[2])))


@jit
def opening(q: _Seven, d: _Six, u: float) -> float:
    """Return the branch f_br, half the opening of the loop, at the scaled velocity u: powers 0-6 over 1-6."""
    top = q[0] + u * (q[1] + u * (q[2] + u * (q[3] + u * (q[4] + u * (q[5] + u * q[6])))))
    return top / (1.0 + u * (d[0] + u * (d[1] + u * (d[2] + u * (d[3] + u * (d[4] + u * d[5]))))))


@branch_damper(
    "yu2019",
    current_order=2,
    max_speed=0.035,
    max_current=1.2,
    temperatures=(20.0, 80.0),
    factors=TemperatureFactors(-0.00667, -0.00667, -0.00667, 20.0),
    fixed=("p_den", "n_den", "q_den", "held_from", "asymmetry"),
)
class Yu2019(NamedTuple):
    """Asymmetric damper: viscous, elastic, and a hysteresis that differs between extension and compression.

        F = c(I) v + k(I) x + alpha(I) [f_ba(v) + f_br(v) sgn(x)],   u = v / v_ref
        f_ba = P(u) for v >= 0,  -N(-u) for v < 0
        P = (p0 + p1 u^2 + p2 u^4) / (1 + P1 u^2 + P2 u^4 + P3 u^6)
        N = (n0 + n1 s + n2 s^2 + n3 s^3) / (1 + N1 s + N2 s^2 + N3 s^3),   s = -u
        f_br = (q0 + q1 u + ... + q6 u^6) / (1 + Q1 u + ... + Q6 u^6)

    c, k and alpha scale with temperature as exp{delta (T - T0)} (eqs 9-11): viscous, stiffness, yield. The
    force is quadratic in the current. sgn(x) is smoothed and taken about the recent mean of the motion
    (`pieces.branch`).

    Read otherwise than printed: eq 2 has f_br sgn(v), which gives no hysteresis, so eq 12 holds; numerators
    and denominators have coefficients of their own, since the shared ones of eq 3 let f_ba vanish for v ->
    inf and keep its sign for v -> -inf; the factor 2 of eq 3 is in P and N. The rationals are held beyond
    `held_from`, the end of the paper's tests, where f_br is down to 0.06 % of alpha; a seat reaches 0.3 m/s.

    Published: the form; tests at 4, 6, 8 mm, 0.5-0.7 Hz (0.035 m/s), 0-1.2 A, 20-80 degC; 33 % less peak
    force and energy at 80 degC. Derived: delta = ln(0.67)/60 K, if all three are equal; one shape for P and N
    and the shape of f_br, from measured sine tests of the damper of UTFSM (see `weng_arctangent`); the height
    of alpha, from the standard deviation of 220 N over the paper's tests that its RMSE of 16.2 N at R2 =
    0.9946 implies. Chosen: that damper's speeds, up to 0.126 m/s, mapped onto the paper's; P/N = 1.1/0.9; c
    and k small and nearly in proportion to alpha; alpha(1.2 A)/alpha(0) = 10.

    `asymmetry` weighs the asymmetric part of the hysteresis: 0 leaves its centrosymmetric part, the ideal
    symmetric damper to compare with (the paper's model I; its conventional model is `yu2017`).

    Source: Yu, Dong, Wang, Pan and Zhou 2019, Front. Mater. 6:227, eqs 1-4 and 9-12; no coefficients are
    published: defaults derived by us from measured loops of another damper and from what the paper states
    """

    c: Annotated[QuadraticLaw, param("N s/m", "viscous damping c(I)")] = (120.0, 600.0, -100.0)
    k: Annotated[LinearLaw, param("N/m", "stiffness k(I)")] = (100.0, 600.0)
    alpha: Annotated[QuadraticLaw, param("N", "height alpha(I) of the hysteresis")] = (41.0, 435.0, -108.0)
    p: Annotated[_Three, param("-", "numerator of P: u^0, u^2, u^4")] = (0.0, 3586.0, 1.298e6)
    p_den: Annotated[_Three, param("-", "denominator of P: u^2, u^4, u^6")] = (14600.0, 1.18e6, 0.0)
    n: Annotated[_Four, param("-", "numerator of N: s^0 to s^3")] = (0.0, 19.17, 0.0, 4140.0)
    n_den: Annotated[_Three, param("-", "denominator of N: s^1 to s^3")] = (62.2, 2.8, 4600.0)
    q: Annotated[_Seven, param("-", "numerator of f_br: u^0 to u^6")] = (0.612, 0.0, 14.4, 0.0, 0.0, 0.0, 0.0)
    q_den: Annotated[_Six, param("-", "denominator of f_br: u^1 to u^6")] = (0.0, 137.7, 0.0, 0.0, 0.0, 9137.0)
    v_ref: Annotated[float, param("m/s", "velocity at which u = 1", above=0, high=10)] = 0.028
    held_from: Annotated[float, param("m/s", "speed from which the rationals are held", above=0)] = 0.0352
    asymmetry: Annotated[float, param("-", "weight of the asymmetric part", low=0, high=1)] = 1.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        u = min(max(v, -self.held_from), self.held_from) / self.v_ref
        s, sign = abs(u), branch(z)
        up, down = rebound(self.p, self.p_den, s), compression(self.n, self.n_den, s)
        here, mirrored = opening(self.q, self.q_den, u) * sign, opening(self.q, self.q_den, -u) * sign
        symmetric = 0.5 * (here + mirrored) + (0.5 * (up + down) if v >= 0.0 else -0.5 * (up + down))
        asymmetric = 0.5 * (here - mirrored + up - down)
        linear = quadratic(self.c, i) * scaling.viscous * v + (self.k[0] + self.k[1] * i) * scaling.stiffness * x
        shape = symmetric + self.asymmetry * asymmetric
        return linear + quadratic(self.alpha, i) * scaling.yield_force * shape + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return branch_rate(v, z)
