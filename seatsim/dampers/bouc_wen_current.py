"""Bouc-Wen dampers whose parameters saturate in the current, and follow the excitation, after Dominguez et al."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.dampers.bouc_wen_variants import NORMALISED, normalised_rate
from seatsim.dampers.pieces import BRANCH_MEMORY, branch_rate, utfsm_damper
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param

AMPLITUDE, LEAST_AMPLITUDE, _MOST_AMPLITUDE = 0.01, 0.001, 0.025
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
    amplitude = min(max(math.sqrt(2.0 * max(s, 0.0)), LEAST_AMPLITUDE), _MOST_AMPLITUDE)
    of_frequency: float = (frequency / _FREQUENCY) ** d2
    of_amplitude: float = (amplitude / AMPLITUDE) ** d4
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
    initial=(0.0, 0.5 * AMPLITUDE**2, 0.5 * (_FREQUENCY * AMPLITUDE) ** 2, 0.0),
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
