"""S-curves of the velocity, shifted by the branch of the loop: arctangent, hyperbolic tangent, sigmoid."""

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, jit, param
from seatsim.dampers.pieces import (
    BRANCH_STATE,
    CurrentLaw,
    QuadraticLaw,
    branch,
    branch_damper,
    branch_rate,
    cubic,
    quadratic,
    utfsm_branch_damper,
    utfsm_damper,
)
from seatsim.dampers.yu import envelope_rate


@utfsm_branch_damper("weng_arctangent", max_speed=0.126)
class WengArctangent(NamedTuple):
    """Arctangent S-curve with a hysteresis of constant width in velocity.

        F = c0(I) v + (2/pi) fc(I) arctan{kH [v - vH(I) sgn(v')]} + f0

    The branch -sgn(v') is the smoothed sign of the displacement about its recent mean (`pieces.branch`), the
    same for harmonic motion. The paper prints no parameters. The defaults are derived by us, from
    measurement: one steady cycle each of 2 mm 5 Hz, 5 mm 3 and 4 Hz, 10 mm 2 Hz, 25 mm 0.25 and 0.5 Hz at 0,
    0.25, 0.5, 0.75, 1 A, offset removed; rms error 22, 37, 72, 123, 189 N at these currents, 10 % of the peak
    force over all. Valid to 0.126 m/s and 1 A, at which the laws are held. Temperature scales c0 (viscous)
    and fc (yield).

    Source: Weng et al., as eq 12 of Braz-Cesar and Barros 2012
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


@branch_damper("kwok_tanh", max_speed=0.1, max_current=2.0, temperatures=(20.0, 20.0), confidence="recalled")
class KwokTanh(NamedTuple):
    """Hyperbolic tangent of the velocity, shifted by the branch of the loop.

        F = c(I) v + k(I) x + alpha(I) tanh{beta v + delta(I) sgn(x)} + f0(I)

    sgn(x) is smoothed and taken about the recent mean of the motion (`pieces.branch`). Defaults: the set of
    the RD-1005-3 for 0-2 A (recalled, corroborated; held at 2 A). Its offset f0 = -257 - 18 I N, which is of
    the accumulator and the load cell's zero, is off by default because the seat's rest position absorbs it;
    give f0_a and f0_b to have it. Tested at 1 Hz 4 mm and 2 Hz 8 mm, up to 0.1 m/s. Temperature scales c
    (viscous), k (elastic) and alpha (yield).

    Source: Kwok, Ha, Nguyen, Li and Samali 2006, Sensors and Actuators A 132:441; RD-1005-3 set recalled, not
    read in the paper, corroborated by the tables of Hong et al. for the same damper
    """

    c_a: Annotated[float, param("N s/m", "viscous damping at zero current", low=0)] = 1232.0
    c_b: Annotated[float, param("N s/(m A)", "rise of the viscous damping with current")] = 1929.0
    k_a: Annotated[float, param("N/m", "stiffness at zero current")] = 5100.0
    k_b: Annotated[float, param("N/(m A)", "rise of the stiffness with current")] = -1700.0
    alpha: Annotated[QuadraticLaw, param("N", "height alpha(I) of the hysteresis")] = (32.0, 918.0, -244.0)
    beta: Annotated[float, param("s/m", "steepness of the S-curve", above=0)] = 100.0
    delta_a: Annotated[float, param("-", "half width of the hysteresis at zero current, times beta")] = 0.58
    delta_b: Annotated[float, param("1/A", "rise of that half width with current")] = 0.30
    f0_a: Annotated[float, param("N", "offset at zero current, of the gas accumulator")] = 0.0
    f0_b: Annotated[float, param("N/A", "rise of the offset with current")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 2.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        viscous = (self.c_a + self.c_b * held) * scaling.viscous * v
        elastic = (self.k_a + self.k_b * held) * scaling.stiffness * x
        curve = math.tanh(self.beta * v + (self.delta_a + self.delta_b * held) * branch(z))
        yielding = quadratic(self.alpha, held) * scaling.yield_force * curve
        return viscous + elastic + yielding + self.f0_a + self.f0_b * held

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w',)."""
        return branch_rate(v, z)


@jit
def logistic(k: float, a: float, s: float) -> float:
    """Return `1 + k / (1 + exp(-a s))`."""
    return 1.0 + k / (1.0 + math.exp(-a * s))


@utfsm_damper(
    "sigmoid",
    initial=(0.0, 0.0),
    state=f"{BRANCH_STATE}; e, envelope of the speed in m/s, for the cycle's peak speed",
    centred=True,
    confidence="recalled",
    fixed=("k0", "k2"),
)
class Sigmoid(NamedTuple):
    """Generalised sigmoid: an S-curve of the velocity whose height and shift follow current and peak speed.

        F  = ft (1 - exp{-as (v + vh)}) / (1 + exp{-as (v + vh)}) (1 + kv |v|) + f0
        ft = ft0 (1 + exp{a1 vm}) [1 + k2 / (1 + exp{-a2 (I + I0)})],   as = a0 / (1 + k0 vm)
        vh = -sgn(v') k4 vm [1 + k3 / (1 + exp{-a3 (I + I1)})]

    The form is recalled, not read in the papers; there vm = sqrt(v'^2 - v'' x'), the peak speed of a sine,
    needs the acceleration. Ours: vm is the causal envelope of the speed (as in `yu2017`), -sgn(v') the
    smoothed sign of the displacement about its recent mean (`pieces.branch`), and the sign of vh that of
    every measured loop.

    Defaults: derived by us from measurement, steady cycles of 2-25 mm and 0.5-5 Hz at 0-1 A, offset
    removed; rms error 18 N at 0 A to 130 N at 1 A, 8 % of the peak force. Valid to 0.13 m/s and 1 A.
    Temperature scales ft (yield) and ft kv (viscous).

    Source: Ma, Wang, Rakheja and Su 2002-2007; form recalled
    """

    ft0: Annotated[float, param("N", "height of the S-curve at no current, over two", low=0.2, high=2000)] = 18.7
    a1: Annotated[float, param("s/m", "rate of the height with the peak speed", low=-20, high=20)] = -0.9
    k2: Annotated[float, param("-", "rise of the height with current", low=0.3, high=3000)] = 30.0
    a2: Annotated[float, param("1/A", "rate of that rise", low=0.05, high=30)] = 5.14
    i0: Annotated[float, param("A", "less the current of its steepest point", low=-5, high=5)] = -0.427
    a0: Annotated[float, param("s/m", "steepness of the S-curve at no speed", low=1, high=1e4)] = 133.0
    k0: Annotated[float, param("s/m", "fall of the steepness with the peak speed", low=0, high=100)] = 0.1
    k4: Annotated[float, param("-", "half width of the loop over the peak speed", low=5e-4, high=0.5)] = 0.0533
    k3: Annotated[float, param("-", "rise of the width with current", low=0, high=100)] = 2.21
    a3: Annotated[float, param("1/A", "rate of that rise", low=0.05, high=30)] = 4.55
    i1: Annotated[float, param("A", "less the current of its steepest point", low=-5, high=5)] = -0.524
    kv: Annotated[float, param("s/m", "viscous rise of the force, over its height", low=0)] = 4.02
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        height = self.ft0 * (1.0 + math.exp(self.a1 * z[1])) * logistic(self.k2, self.a2, i + self.i0)
        shift = self.k4 * z[1] * logistic(self.k3, self.a3, i + self.i1) * branch(z)
        curve = math.tanh(0.5 * self.a0 / (1.0 + self.k0 * z[1]) * (v + shift))
        return height * curve * (scaling.yield_force + self.kv * abs(v) * scaling.viscous) + self.f0

    def rates(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> State:
        """Return (w', e')."""
        return (*branch_rate(v, z), envelope_rate(abs(v), z[1]))
