"""Normalised Bouc-Wen dampers: shear-mode, large-scale, non-symmetrical, and those of Dominguez et al.

The parameters of the last saturate in the current, and follow the excitation.
"""

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, jit, param
from seatsim.dampers.pieces import (
    BRANCH_MEMORY,
    CurrentLaw,
    between,
    branch_rate,
    cubic,
    inertance,
    inertance_rate,
    power,
    utfsm_damper,
)

NORMALISED = "w, hysteretic variable from -1 to 1"


@jit
def normalised_rate(rho: float, sigma: float, n: float, r: float, w: float) -> float:
    """Return `rho {r - sigma |r| |w|^(n-1) w + (sigma - 1) r |w|^n}` at velocity r; it keeps |w| <= 1."""
    size = power(abs(w), n)
    return rho * r * (1.0 - size if r * w >= 0.0 else 1.0 + (2.0 * sigma - 1.0) * size)


@utfsm_damper("shear_bouc_wen", initial=(0.0,), state=NORMALISED, confidence="recalled")
class ShearBoucWen(NamedTuple):
    """Shear-mode Bouc-Wen damper: a dashpot beside a hysteresis, no spring.

        F  = kx(I) v + kw(I) w + f0
        w' = rho(I) {v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n},   |w| <= 1

    The simple Bouc-Wen damper without its spring; normalised, w stays within its bounds when the current
    changes. Dissipative for sigma >= 1/2. The form is recalled, not read in the papers, which have laws
    linear in the voltage; ours are cubic, rho linear between zero current and `law_end`.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 20 N at 0 A to 100 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales kx (viscous) and kw (yield).

    Source: Jansen and Dyke 2000, normalised after Ikhouane and Dyke 2007, Smart Mater. Struct. 16:605; form
    recalled
    """

    kx: Annotated[CurrentLaw, param("N s/m", "viscous damping kx(I)")] = (980.0, 3020.0, 4450.0, -3340.0)
    kw: Annotated[CurrentLaw, param("N", "yield force kw(I)")] = (112.0, 584.0, 1228.0, -871.0)
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=100, high=1e6)] = 10400.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=30, high=3e5)] = 2850.0
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 15.0
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.4
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        return cubic(self.kx, held) * scaling.viscous * v + cubic(self.kw, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        rho = between(self.rho0, self.rho1, i, self.law_end)
        return (normalised_rate(rho, self.sigma, self.n, v, z[0]),)


@utfsm_damper(
    "large_scale_bouc_wen",
    initial=(0.0, 0.0),
    state=f"{NORMALISED}; u, velocity of the inertance in m/s",
    confidence="recalled",
)
class LargeScaleBoucWen(NamedTuple):
    """Bouc-Wen damper for large dampers: damping that falls with speed, and the inertia of fluid and piston.

        F  = alpha(I) w + k x + a1(I) exp{-(a2 |v|)^p} v + m (v - u) / tau + f0
        w' = rho(I) {v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n},   |w| <= 1
        u' = (v - u) / tau

    The form is recalled, not read in the paper; its hysteresis is normalised here. The paper has m v' where we have
    an inertance behind a dashpot m / tau, tau = 2 ms: the same in slow motion, and passive
    without need of the acceleration. a1 exp{..} is stiction at low speed and shear thinning at high speed.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 16 N at 0 A to 75 N at 1 A, 6 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales a1 and, so that the whole force follows, m (viscous), k (elastic) and alpha (yield).

    Source: Yang, Spencer, Jung and Carlson 2004, J. Eng. Mech. 130:1107; form recalled
    """

    a1: Annotated[CurrentLaw, param("N s/m", "damping a1(I) at low speed")] = (12400.0, 58000.0, 8900.0, -15200.0)
    alpha: Annotated[CurrentLaw, param("N", "yield force alpha(I)")] = (59.7, 245.0, 1451.0, -961.0)
    a2: Annotated[float, param("s/m", "decay of the damping with speed", low=0.1, high=1e4)] = 100.0
    p: Annotated[float, param("-", "exponent of that decay", low=0.05, high=5)] = 0.335
    k: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 830.0
    m: Annotated[float, param("kg", "inertia of fluid and piston", low=0, high=400)] = 4.0
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=100, high=1e6)] = 8700.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=30, high=3e5)] = 2880.0
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 3.1
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        thinned = cubic(self.a1, held) * math.exp(-power(self.a2 * abs(v), self.p)) * v
        flow = (thinned + inertance(self.m, v, z[1])) * scaling.viscous
        return flow + self.k * scaling.stiffness * x + cubic(self.alpha, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w', u')."""
        rho = between(self.rho0, self.rho1, i, self.law_end)
        return (normalised_rate(rho, self.sigma, self.n, v, z[0]), inertance_rate(v, z[1]))


@utfsm_damper("nonsymmetrical_bouc_wen", initial=(0.0,), state=NORMALISED, confidence="recalled", fixed=("mu",))
class NonsymmetricalBoucWen(NamedTuple):
    """Bouc-Wen damper whose hysteresis sees the velocity shifted by mu, so that the loop is not symmetric.

        F  = c(I) v + k x + alpha(I) w + f0
        w' = rho(I) {1 - |w|^n [1 - sigma + sigma sgn(w r)]} r,   r = v - mu,   |w| <= 1

    The form is recalled, not read in the paper: there `z' = {A - |z|^n [gamma + beta sgn(z r)]} r`, here
    normalised with rho = A, rho (1 - sigma) = gamma, rho sigma = beta. With mu != 0 a damper at rest creeps:
    w drifts to -sgn(mu) at the rate rho |mu|, and the force with it, so that the form is dissipative over
    closed cycles only; mu is 0 by default.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 19 N at 0 A to 100 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous), k (elastic) and alpha (yield).

    Source: Kwok, Ha, Nguyen, Li and Samali 2007, ISA Trans. 46:167; form recalled
    """

    c: Annotated[CurrentLaw, param("N s/m", "viscous damping c(I)")] = (990.0, 3030.0, 4520.0, -3410.0)
    alpha: Annotated[CurrentLaw, param("N", "yield force alpha(I)")] = (110.5, 584.5, 1219.0, -863.6)
    mu: Annotated[float, param("m/s", "velocity about which the hysteresis is symmetric", low=-0.02, high=0.02)] = 0.0
    k: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 440.0
    rho0: Annotated[float, param("1/m", "slope of w from zero, at zero current", low=100, high=1e6)] = 10900.0
    rho1: Annotated[float, param("1/m", "the same at law_end", low=30, high=3e5)] = 2860.0
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 15.0
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.4
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        smooth = cubic(self.c, held) * scaling.viscous * v + self.k * scaling.stiffness * x
        return smooth + cubic(self.alpha, held) * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        rho = between(self.rho0, self.rho1, i, self.law_end)
        return (normalised_rate(rho, self.sigma, self.n, v - self.mu, z[0]),)


_AMPLITUDE, _LEAST_AMPLITUDE, _MOST_AMPLITUDE = 0.01, 0.001, 0.025
"""Amplitude in m at which the factor of the excitation is 1, and the range beyond which it is held."""
_FREQUENCY, _LEAST_FREQUENCY, _MOST_FREQUENCY = 2.0 * math.pi, 0.2 * math.pi, 30.0 * math.pi
"""Angular frequency in rad/s at which that factor is 1, and the range beyond which it is held."""
_AT_REST = 1e-10
"""Mean square of the displacement in m^2 far below which the motion has no frequency: it counts as `_FREQUENCY`."""


@jit
def saturating(first: float, knee: float, rise: float, rate: float, i: float, i_c: float) -> float:
    """Return a law linear from `first` at zero to `knee` at `i_c`, then `knee + rise (1 - exp(-rate (i - i_c)))`."""
    if i <= i_c:
        return first + (knee - first) * i / i_c
    return knee + rise * (1.0 - math.exp(-rate * (i - i_c)))


@jit
def excitation_factor(d2: float, d4: float, s: float, r: float) -> float:
    """Return `(W / W0)^d2 (X / X0)^d4` from the mean squares s of displacement [m^2] and r of velocity [m^2/s^2]."""
    squared = (max(r, 0.0) + _AT_REST * _FREQUENCY**2) / (max(s, 0.0) + _AT_REST)
    frequency = min(max(math.sqrt(squared), _LEAST_FREQUENCY), _MOST_FREQUENCY)
    amplitude = min(max(math.sqrt(2.0 * max(s, 0.0)), _LEAST_AMPLITUDE), _MOST_AMPLITUDE)
    of_frequency: float = (frequency / _FREQUENCY) ** d2
    of_amplitude: float = (amplitude / _AMPLITUDE) ** d4
    return of_frequency * of_amplitude


@utfsm_damper("current_dependent_bouc_wen", initial=(0.0,), state=NORMALISED, confidence="recalled")
class CurrentDependentBoucWen(NamedTuple):
    """Bouc-Wen damper whose damping and yield force saturate in the current.

        F  = c(I) v + k x + alpha(I) w + f0
        w' = S / alpha(I) {v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n},   |w| <= 1
        q(I) = q1 + q2 [1 - exp{-q3 (I - Ic)}] for I > Ic,   q0 + (q1 - q0) I / Ic below;   q = c, alpha

    The law in the current is recalled, not read in the paper, its straight line below Ic least surely. Ours:
    the normalised hysteresis, and one pre-yield stiffness S at all currents, so that the displacement at
    yield grows with the current.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 20 N at 0 A to 99 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous), k (elastic) and alpha (yield).

    Source: Dominguez, Sedaghati and Stiharu 2004, Smart Mater. Struct. 13:1351; form recalled
    """

    c_0: Annotated[float, param("N s/m", "damping c0 at zero current", low=0)] = 1025.0
    c_1: Annotated[float, param("N s/m", "damping c1 at i_c", low=0)] = 2017.0
    c_2: Annotated[float, param("N s/m", "its rise c2 beyond i_c", low=0)] = 5650.0
    c_3: Annotated[float, param("1/A", "rate c3 at which the damping saturates", low=0.01, high=50)] = 1.06
    alpha_0: Annotated[float, param("N", "yield force alpha0 at zero current", above=0)] = 107.4
    alpha_1: Annotated[float, param("N", "yield force alpha1 at i_c", above=0)] = 314.0
    alpha_2: Annotated[float, param("N", "its rise alpha2 beyond i_c", low=0)] = 1703.0
    alpha_3: Annotated[float, param("1/A", "rate alpha3 at which it saturates", low=0.01, high=50)] = 0.766
    i_c: Annotated[float, param("A", "current below which the laws are linear", low=0.01, high=1)] = 0.25
    stiffness: Annotated[float, param("N/m", "stiffness S before yield", low=3e4, high=3e8)] = 3.33e6
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 15.0
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.5
    k: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 650.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        c = saturating(self.c_0, self.c_1, self.c_2, self.c_3, i, self.i_c)
        alpha = saturating(self.alpha_0, self.alpha_1, self.alpha_2, self.alpha_3, i, self.i_c)
        smooth = c * scaling.viscous * v + self.k * scaling.stiffness * x
        return smooth + alpha * scaling.yield_force * z[0] + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        alpha = saturating(self.alpha_0, self.alpha_1, self.alpha_2, self.alpha_3, i, self.i_c)
        return (normalised_rate(self.stiffness / alpha, self.sigma, self.n, v, z[0]),)


@utfsm_damper(
    "frequency_dependent_bouc_wen",
    initial=(0.0, 0.5 * _AMPLITUDE**2, 0.5 * (_FREQUENCY * _AMPLITUDE) ** 2, 0.0),
    state="d, displacement about its recent mean in m; s, recent mean square of d in m^2; r, recent mean square of"
    f" the velocity in m^2/s^2; {NORMALISED}",
    confidence="reading",
)
class FrequencyDependentBoucWen(NamedTuple):
    """Bouc-Wen damper that depends on current, frequency and amplitude.

        F  = (W / W0)^d2 (X / X0)^d4 [c(I) v + k x + alpha(I) w] + f0
        w' = S / alpha(I) {v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n},   |w| <= 1
        W  = sqrt(r / s),   X = sqrt(2 s)
        d' = v - d / T,   s' = (d^2 - s) / T,   r' = (v^2 - r) / T,   T = 1 s

    c and alpha saturate in the current as in `current_dependent_bouc_wen`. Recalled, not read in the papers:
    that powers of the angular frequency W and of the amplitude X multiply the whole force, for harmonic tests.
    Ours: W and X of any motion, from the recent mean squares r of the velocity and s of the displacement d
    about its recent mean, exact for sines (a second after their start); W0 = 2 pi 1 Hz and X0 = 10 mm in place
    of the two coefficients; W held outside 0.1-15 Hz and X outside 1-25 mm.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 19 N at 0 A to 99 N at 1 A, 7 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales c (viscous), k (elastic) and alpha (yield).

    Source: Dominguez, Sedaghati and Stiharu 2006, Smart Mater. Struct. 15:1179, of which only the structure
    is recalled; frequency and amplitude from running mean squares are ours
    """

    c_0: Annotated[float, param("N s/m", "damping c0 at zero current", low=0)] = 1174.0
    c_1: Annotated[float, param("N s/m", "damping c1 at i_c", low=0)] = 2373.0
    c_2: Annotated[float, param("N s/m", "its rise c2 beyond i_c", low=0)] = 7170.0
    c_3: Annotated[float, param("1/A", "rate c3 at which the damping saturates", low=0.01, high=50)] = 1.02
    alpha_0: Annotated[float, param("N", "yield force alpha0 at zero current", above=0)] = 105.4
    alpha_1: Annotated[float, param("N", "yield force alpha1 at i_c", above=0)] = 305.0
    alpha_2: Annotated[float, param("N", "its rise alpha2 beyond i_c", low=0)] = 1697.0
    alpha_3: Annotated[float, param("1/A", "rate alpha3 at which it saturates", low=0.01, high=50)] = 0.757
    i_c: Annotated[float, param("A", "current below which the laws are linear", low=0.01, high=1)] = 0.25
    d2: Annotated[float, param("-", "exponent of the frequency", low=-1, high=1)] = -0.11
    d4: Annotated[float, param("-", "exponent of the amplitude", low=-1, high=1)] = -0.1
    stiffness: Annotated[float, param("N/m", "stiffness S before yield", low=3e4, high=3e8)] = 3.39e6
    sigma: Annotated[float, param("-", "half the slope of unloading over that of loading", low=0.5, high=200)] = 13.1
    n: Annotated[float, param("-", "sharpness of yielding", low=1, high=20)] = 1.5
    k: Annotated[float, param("N/m", "stiffness, of the gas accumulator", low=0)] = 800.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        c = saturating(self.c_0, self.c_1, self.c_2, self.c_3, i, self.i_c)
        alpha = saturating(self.alpha_0, self.alpha_1, self.alpha_2, self.alpha_3, i, self.i_c)
        smooth = c * scaling.viscous * v + self.k * scaling.stiffness * x
        return excitation_factor(self.d2, self.d4, z[1], z[2]) * (smooth + alpha * scaling.yield_force * z[3]) + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (d', s', r', w')."""
        alpha = saturating(self.alpha_0, self.alpha_1, self.alpha_2, self.alpha_3, i, self.i_c)
        w = normalised_rate(self.stiffness / alpha, self.sigma, self.n, v, z[3])
        s, r = (z[0] * z[0] - z[1]) / BRANCH_MEMORY, (v * v - z[2]) / BRANCH_MEMORY
        return (*branch_rate(v, z), s, r, w)
