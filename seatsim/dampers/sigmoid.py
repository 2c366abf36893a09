"""Sigmoid damper after Ma, Wang and Rakheja: an S-curve whose height, steepness and shift follow the peak speed."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.dampers.base import damper
from seatsim.dampers.hysteresis_division import envelope_rate
from seatsim.dampers.pieces import BRANCH_STATE, UTFSM, branch, branch_rate
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param


@jit
def logistic(k: float, a: float, s: float) -> float:
    """Return `1 + k / (1 + exp(-a s))`."""
    return 1.0 + k / (1.0 + math.exp(-a * s))


@damper(
    "sigmoid",
    source=f"Ma, Wang, Rakheja and Su 2002-2007; form recalled; {UTFSM}",
    initial=(0.0, 0.0),
    state=f"{BRANCH_STATE}; e, envelope of the speed in m/s, for the cycle's peak speed",
    centred=True,
    max_speed=0.13,
    max_current=1.0,
    temperatures=(20.0, 20.0),
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
