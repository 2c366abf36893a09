"""Bingham dampers: a viscous dashpot beside Coulomb friction, and their extensions by further terms."""

import math
from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, damper, param
from seatsim.dampers.pieces import CurrentLaw, cubic, power, utfsm_damper

_SET_VALUED_BELOW = 1e-6
"""m/s; a sharper `v_ref` than this is taken as the set-valued sign itself."""


@damper("bingham", current_order=1, complete=True, fixed=("v_ref",))
class Bingham(NamedTuple):
    """Bingham damper with laws linear in the current.

        F = (c_a + c_b i) v + (fc_a + fc_b i) tanh(v / v_ref) + f0

    `v_ref` regularises the sign; 0 means the sign itself, set-valued at rest (`|F - f0| <= fc` at v = 0).

    Source: Stanway, Sproston and Stevens 1987, J. Electrostatics 20:167
    """

    c_a: Annotated[float, param("N s/m", "viscous damping at zero current", low=0)] = 250.0
    c_b: Annotated[float, param("N s/(m A)", "rise of the viscous damping with current")] = 350.0
    fc_a: Annotated[float, param("N", "yield force at zero current", low=0)] = 45.0
    fc_b: Annotated[float, param("N/A", "rise of the yield force with current")] = 620.0
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    v_ref: Annotated[float, param("m/s", "speed that regularises the sign", low=0, high=1)] = 0.004

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N, without the friction where that is set-valued."""
        smooth = (self.c_a + self.c_b * i) * scaling.viscous * v + self.f0
        if self.v_ref < _SET_VALUED_BELOW:
            return smooth
        return smooth + (self.fc_a + self.fc_b * i) * scaling.yield_force * math.tanh(v / self.v_ref)

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the set-valued friction in N; 0 where the sign is regularised."""
        if self.v_ref < _SET_VALUED_BELOW:
            return max(0.0, (self.fc_a + self.fc_b * i) * scaling.yield_force)
        return 0.0


@damper("original_bingham", max_speed=0.13, max_current=1.0)
class OriginalBingham(NamedTuple):
    """Bingham damper with cubic current laws and a set-valued yield force: `F = c0(I) v + fc(I) sgn(v) + f0`.

    Defaults are a surrogate of the RD-1005-3 (derived, not published): fitted over 0.5-2 Hz, 2-10 mm and 0-1
    A, rms 20-279 N; `f0` is the paper's 40 N, off by default because the seat's rest position absorbs it.

    Source: Stanway et al. 1987 with the current laws of Braz-Cesar and Barros 2012 eqs 4.1-4.2, whose printed
    numbers are lost: defaults fitted by us to their modified Bouc-Wen model of the RD-1005-3
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I)")] = (940.0, 13280.0, 20350.0, -20040.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (35.7, 390.0, 675.0, -609.3)
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the smooth part of F in N."""
        return cubic(self.c0, i) * scaling.viscous * v + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the set-valued yield force in N."""
        return max(0.0, cubic(self.fc, i) * scaling.yield_force)


@utfsm_damper("updated_bingham", confidence="reading")
class UpdatedBingham(NamedTuple):
    """Bingham damper whose viscous damping depends on the speed, with a set-valued yield force.

        F = C(I, |v|) v + fc(I) sgn(v) + f0,   C = c0(I) (1 + |v| / v_s)^(p - 1)

    Vaguely recalled is that the viscous coefficient is a function of current and speed; which one was not
    found. The function here is ours: c0 at rest, c0 v_s^(1-p) |v|^(p-1) for |v| >> v_s, a power law without its
    infinite damping at rest; p = 1 is the Bingham damper. c0 and fc are cubic laws, held beyond `law_end`. The
    defaults are derived by us (see `pieces.UTFSM`), with fc, which these data leave next to nothing of,
    chosen; rms error 28, 62, 133, 216, 284 N at 0, 0.25, 0.5, 0.75, 1 A. Valid to 0.13 m/s and 1 A. Temperature
    scales c0 (viscous) and fc (yield).

    Source: Occhiuzzi, Spizzuoco and Serino 2003, Smart Mater. Struct. 12:703; form vaguely recalled, their
    function C(I, |v|) not found and read by us as shear thinning
    """

    c0: Annotated[CurrentLaw, param("N s/m", "viscous damping c0(I) at rest")] = (18030.0, 75540.0, 155800.0, -110400.0)
    fc: Annotated[CurrentLaw, param("N", "yield force fc(I)")] = (16.0, 90.0, 130.0, -110.0)
    p: Annotated[float, param("-", "exponent of the speed at high speed", low=0.02, high=2)] = 0.109
    v_s: Annotated[float, param("m/s", "speed from which the damping falls", low=2e-4, high=1)] = 0.0082
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the part of F in N that is not set-valued."""
        thinning = power(1.0 + abs(v) / self.v_s, self.p - 1.0)
        return cubic(self.c0, min(i, self.law_end)) * scaling.viscous * thinning * v + self.f0

    def coulomb(self, i: float, scaling: TemperatureScaling) -> float:
        """Return the magnitude of the set-valued yield force in N."""
        return max(0.0, cubic(self.fc, min(i, self.law_end)) * scaling.yield_force)


@utfsm_damper("powell", confidence="recalled")
class Powell(NamedTuple):
    """Three elements side by side: a spring, a dashpot, and friction that falls from static to dynamic.

        F = k x + c(I) v + fc(I) [1 + (r - 1) exp(-a |v|)] tanh(e v) + f0,   r = fs / fc

    fc is the dynamic and fs the static friction; tanh(e v) regularises the sign. The form is recalled; the
    original has e large. c and fc are cubic laws, held beyond `law_end`. The defaults are derived by us (see
    `pieces.UTFSM`) with k chosen; rms error 25, 58, 129, 213, 281 N at 0, 0.25, 0.5, 0.75, 1 A. In them e is
    the slope of the pre-yield flow, and r and a round its corner: no static friction was seen. Valid to 0.13 m/s
    and 1 A. Temperature scales c (viscous), k (elastic) and fc (yield).

    Source: Powell 1994, Smart Mater. Struct. 3:416; form recalled, no parameter set found
    """

    c: Annotated[CurrentLaw, param("N s/m", "viscous damping c(I)")] = (377.0, 556.0, 5353.0, -3467.0)
    fc: Annotated[CurrentLaw, param("N", "dynamic friction fc(I)")] = (162.8, 767.5, 1278.0, -945.4)
    k: Annotated[float, param("N/m", "stiffness k", low=0, high=1e5)] = 500.0
    r: Annotated[float, param("-", "static over dynamic friction", low=0.1, high=10)] = 3.9
    a: Annotated[float, param("s/m", "rate at which static friction falls with speed", low=1, high=1e4)] = 97.0
    e: Annotated[float, param("s/m", "steepness of the sign", low=1, high=4000)] = 31.6
    f0: Annotated[float, param("N", "offset, of the gas accumulator")] = 0.0
    law_end: Annotated[float, param("A", "current beyond which the laws are held", above=0)] = 1.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return F in N."""
        held = min(i, self.law_end)
        friction = (1.0 + (self.r - 1.0) * math.exp(-self.a * abs(v))) * math.tanh(self.e * v)
        linear = self.k * scaling.stiffness * x + cubic(self.c, held) * scaling.viscous * v
        return linear + cubic(self.fc, held) * scaling.yield_force * friction + self.f0
