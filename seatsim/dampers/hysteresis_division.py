"""Hysteresis-division damper after Yu, Dong and Zhang: the conventional model of Yu et al. 2019."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.compilation.jit import jit
from seatsim.dampers.base import damper
from seatsim.dampers.pieces import BRANCH_STATE, UTFSM, branch, branch_rate
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.fields import param

RISE_TIME = 0.01
"""Time in s in which the envelope of the speed takes up a higher speed."""
DECAY_TIME = 2.0
"""Time in s in which it forgets a lower one."""


@jit
def envelope_rate(speed: float, envelope: float) -> float:
    """Return the rate of the envelope of the speed in m/s^2: fast to a higher speed, slow to a lower one."""
    return (speed - envelope) / (RISE_TIME if speed > envelope else DECAY_TIME)


@damper(
    "yu2017",
    source=f"Yu, Dong and Zhang 2017, Smart Mater. Struct. 26, as eq 5 of Yu et al. 2019 (conventional model); {UTFSM}",
    initial=(0.0, 0.0),
    state=f"{BRANCH_STATE}; e, envelope of the speed in m/s, for the cycle's peak speed",
    centred=True,
    max_speed=0.126,
    max_current=1.0,
    temperatures=(20.0, 20.0),
    confidence="published",
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
