"""Fault scenarios of damper and coil: two or more forms of each effect of the contract.

A function takes the severity s (1 is common on a real rig), the drawn shape d and what is known of the rig without it.
Shares stay below 1, so that nothing changes its sign.
"""

from __future__ import annotations

import functools
import math

from numpy.random import Generator

from seatsim.blind.truth.faults import (
    Changes,
    Context,
    FaultScenario,
    Shape,
    drawn,
    enter,
    set_parameters,
)

_COIL_RATE = 130.0
"""1/s, of the nominal coil; the second pole is faster by 1 / ratio."""
SCENARIOS: dict[str, FaultScenario] = {}
_fault = functools.partial(enter, SCENARIOS)
_FADE = drawn(**{"yield": (0.35, 1.0)})
_GAS = drawn(length=(0.09, 0.2), n=(1.05, 1.4), rate=(4.0, 14.0))
_ASYMMETRY = drawn(sign=[-1.0, 1.0], back=(0.0, 0.8), mix=(0.5, 1.2), speed=(0.01, 0.05))
_PREYIELD = drawn(length=(1e-4, 5e-4), tau=(0.002, 0.006))
_RELAYS = drawn(width=(0.15, 0.5))
_MAGNET = drawn(tau=(0.25, 1.5))
_MOUNT = drawn(stiffness=(4e6, 5.5e6))
_SEAL = drawn(stribeck=(1.05, 1.4), speed=(0.005, 0.03), length=(5e-5, 2e-4), pressure=(0.1, 0.4))
_LAG = drawn(ratio=(0.1, 0.4), slow=(25.0, 50.0))
_JITTER = drawn(jitter=(0.1, 0.35))
_LIMIT = drawn(power=(7.0, 20.0), sag=(0.1, 0.35))


@_fault("fade-arrhenius", "damper.thermal_fade", (0.1, 4.0), _FADE)
def _arrhenius(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(fade_law=1.0, fade_viscous=1.1 * s, fade_yield=0.004 * d["yield"] * s)


@_fault("fade-power", "damper.thermal_fade", (0.1, 4.0), _FADE)
def _power_fade(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(fade_law=2.0, fade_viscous=0.012 * s, fade_yield=1.3 * d["yield"] * s)


@_fault("gas-polytropic", "damper.gas_spring", (0.02, 4.0), _GAS)
def _polytropic(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(gas_law=1.0, gas_force=60.0 * s, gas_length=d["length"], gas_exponent=d["n"])


@_fault("gas-accumulator", "damper.gas_spring", (0.02, 4.0), _GAS)
def _accumulator(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(gas_law=2.0, gas_force=45.0 * s, gas_rate=45.0 * d["rate"] * s, gas_length=d["length"])


@_fault("asymmetry-all", "damper.asymmetry", (0.05, 6.0), _ASYMMETRY)
def _asymmetry_both(s: float, d: Shape, _: Context) -> Changes:
    up, down = 0.15 * s * d["sign"], -0.15 * s * d["sign"] * d["back"]
    viscous = set_parameters(asym_viscous_up=max(up * d["mix"], -0.9), asym_viscous_down=max(down * d["mix"], -0.9))
    return viscous + set_parameters(asym_yield_up=max(up, -0.9), asym_yield_down=max(down, -0.9), asym_speed=d["speed"])


@_fault("asymmetry-viscous", "damper.asymmetry", (0.05, 5.0), _ASYMMETRY)
def _asymmetry_viscous(s: float, d: Shape, _: Context) -> Changes:
    down = max(-0.35 * s * d["back"], -0.9)
    return set_parameters(asym_viscous_up=0.35 * s, asym_viscous_down=down, asym_speed=d["speed"])


@_fault("preyield-dahl", "damper.preyield_hysteresis", (0.02, 15.0), _PREYIELD, bingham=True)
def _dahl(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(preyield_share=min(s, 1.0), preyield_length=d["length"] * max(s, 1.0))


@_fault("preyield-lag", "damper.preyield_hysteresis", (0.05, 8.0), _PREYIELD, bingham=True)
def _fluid_lag(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(preyield_share=min(s, 1.0), preyield_time=d["tau"] * max(s, 1.0))


@_fault("saturation-froehlich", "damper.magnetic_saturation", (0.05, 8.0))
def _froehlich(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(saturation_froehlich=0.3 * s)


@_fault("saturation-langevin", "damper.magnetic_saturation", (0.1, 6.0))
def _langevin(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(saturation_langevin=0.6 * s)


@_fault("remanence-relays", "damper.remanence", (0.05, 3.5), _RELAYS)
def _relays(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(relay_share=min(0.4 * s, 0.95), relay_width=d["width"] * max(0.4 * s / 0.95, 1.0) ** 0.7)


@_fault("remanence-decay", "damper.remanence", (0.05, 6.0), _MAGNET)
def _magnet(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(remanence_gain=min(0.15 * s, 0.9), remanence_time=d["tau"])


@_fault("play-contact", "damper.free_play", (0.005, 6.0), _MOUNT)
def _play(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(play_gap=0.0006 * s, mount_stiffness=d["stiffness"])


@_fault("play-air", "damper.free_play", (0.005, 6.0), _MOUNT)
def _air(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(play_air=0.0004 * s, mount_stiffness=d["stiffness"])


def _gap_shape(rng: Generator, _: Context) -> Shape:
    return {"gap": math.exp(rng.uniform(math.log(1e-4), math.log(1.5e-3)))}


@_fault("play-turn", "damper.free_play", (0.8, 1.2), _gap_shape)
def _turn(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(play_gap=d["gap"] * s, play_turn=1.0)


@_fault("seal-lugre", "damper.seal_friction", (0.05, 6.0), _SEAL)
def _seal(s: float, d: Shape, _: Context) -> Changes:
    shape = set_parameters(seal_stribeck=d["stribeck"], seal_speed=d["speed"], seal_length=d["length"])
    return shape + set_parameters(seal_force=25.0 * s, seal_pressure=0.0)


@_fault("seal-pressure", "damper.seal_friction", (0.05, 6.0), _SEAL)
def _pressed_seal(s: float, d: Shape, context: Context) -> Changes:
    return _seal(s, d, context) + set_parameters(seal_force=22.0 * s, seal_pressure=d["pressure"])


@_fault("lag-eddy", "coil.lag", (0.02, 12.0), _LAG)
def _two_poles(s: float, d: Shape, _: Context) -> Changes:
    # eddy currents as a second pole; the first one is slowed too, so that the whole step response is later
    return set_parameters(second_rate=_COIL_RATE / (d["ratio"] * s), rate_factor=1.0 / (1.0 + 0.6 * s))


@_fault("lag-branches", "coil.lag", (0.02, 8.0), _LAG)
def _branches(s: float, d: Shape, _: Context) -> Changes:
    # a fast branch and a slow one; where its share cannot grow any more, the slow branch is slowed instead
    share, more = min(0.3 * s, 0.95), max(0.3 * s - 0.95, 0.0)
    return set_parameters(slow_share=share, slow_rate=d["slow"] / (1.0 + more), rate_factor=1.0 / (1.0 + 0.25 * s))


@_fault("fall-diode", "coil.asymmetric_lag", (0.02, 15.0))
def _fall(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(fall_law=1.0, fall_slow=0.6 * s)


@_fault("fall-low", "coil.asymmetric_lag", (0.02, 15.0))
def _fall_low(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(fall_law=2.0, fall_slow=0.6 * s)


@_fault("delay-pure", "coil.delay", (0.05, 8.0))
def _delay(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(delay=0.004 * s)


@_fault("delay-jitter", "coil.delay", (0.05, 8.0), _JITTER)
def _jitter(s: float, d: Shape, _: Context) -> Changes:
    return set_parameters(delay=0.004 * s, delay_jitter=d["jitter"])


@_fault("limit-soft", "coil.current_limit", (0.02, 8.0), _LIMIT)
def _ceiling(s: float, d: Shape, _: Context) -> Changes:
    # well above the supply at a severity near zero, and so sharp there that no current below it is changed
    return set_parameters(limit=1.25 / (1.0 + 0.5 * s), limit_power=d["power"] + 4.0 / s)


@_fault("limit-sag", "coil.current_limit", (0.02, 6.0), _LIMIT)
def _sagging(s: float, d: Shape, _: Context) -> Changes:
    # the sag lowers the limit by itself, so this starts a little higher than the limit above
    limit, sag = 1.25 / (1.0 + 0.45 * s), d["sag"] * min(s, 1.5)
    return set_parameters(limit=limit, limit_power=d["power"] + 4.0 / s, limit_sag=sag)
