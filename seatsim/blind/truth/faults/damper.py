"""Fault scenarios of the damper's effects; equations in `physics.damper`, `mount`, `magnetisation`, `temperature`.

Sizes are such that a severity of 1 is common on a real rig. Shares stay below 1, so that nothing changes its sign.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from seatsim.blind.truth.faults.scenario import (
    Build,
    Changes,
    Context,
    Draw,
    FaultScenario,
    Shape,
    draw_nothing,
    set_parameters,
)


def _fade_shape(rng: Generator, _: Context) -> Shape:
    return {"yield": rng.uniform(0.35, 1.0)}


def _arrhenius(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(fade_law=1.0, fade_viscous=1.1 * severity, fade_yield=0.004 * shape["yield"] * severity)


def _power_fade(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(fade_law=2.0, fade_viscous=0.012 * severity, fade_yield=1.3 * shape["yield"] * severity)


def _gas_shape(rng: Generator, _: Context) -> Shape:
    return {"length": rng.uniform(0.09, 0.2), "n": rng.uniform(1.05, 1.4), "rate": rng.uniform(4.0, 14.0)}


def _polytropic(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(gas_law=1.0, gas_force=60.0 * severity, gas_length=shape["length"], gas_exponent=shape["n"])


def _accumulator(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        gas_law=2.0, gas_force=45.0 * severity, gas_rate=45.0 * shape["rate"] * severity, gas_length=shape["length"]
    )


def _asymmetry_shape(rng: Generator, _: Context) -> Shape:
    return {
        "sign": float(rng.choice([-1.0, 1.0])), "back": rng.uniform(0.0, 0.8), "mix": rng.uniform(0.5, 1.2),
        "speed": rng.uniform(0.01, 0.05),
    }  # fmt: skip


def _asymmetry_both(severity: float, shape: Shape, _: Context) -> Changes:
    up, down = 0.15 * severity * shape["sign"], -0.15 * severity * shape["sign"] * shape["back"]
    return set_parameters(
        asym_viscous_up=max(up * shape["mix"], -0.9),
        asym_viscous_down=max(down * shape["mix"], -0.9),
        asym_yield_up=max(up, -0.9),
        asym_yield_down=max(down, -0.9),
        asym_speed=shape["speed"],
    )


def _asymmetry_viscous(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        asym_viscous_up=0.35 * severity,
        asym_viscous_down=max(-0.35 * severity * shape["back"], -0.9),
        asym_speed=shape["speed"],
    )


def _preyield_shape(rng: Generator, _: Context) -> Shape:
    return {"length": rng.uniform(1e-4, 5e-4), "tau": rng.uniform(0.002, 0.006)}


def _dahl(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(preyield_share=min(severity, 1.0), preyield_length=shape["length"] * max(severity, 1.0))


def _fluid_lag(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(preyield_share=min(severity, 1.0), preyield_time=shape["tau"] * max(severity, 1.0))


def _froehlich(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(saturation_froehlich=0.3 * severity)


def _langevin(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(saturation_langevin=0.6 * severity)


def _relay_shape(rng: Generator, _: Context) -> Shape:
    return {"width": rng.uniform(0.15, 0.5)}


def _relays(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(
        relay_share=min(0.4 * severity, 0.95), relay_width=shape["width"] * max(0.4 * severity / 0.95, 1.0) ** 0.7
    )


def _magnet_shape(rng: Generator, _: Context) -> Shape:
    return {"tau": rng.uniform(0.25, 1.5)}


def _magnet(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(remanence_gain=min(0.15 * severity, 0.9), remanence_time=shape["tau"])


def _mount_shape(rng: Generator, _: Context) -> Shape:
    return {"stiffness": rng.uniform(4e6, 5.5e6)}


def _play(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(play_gap=0.0006 * severity, mount_stiffness=shape["stiffness"])


def _air(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(play_air=0.0004 * severity, mount_stiffness=shape["stiffness"])


def _gap_shape(rng: Generator, _: Context) -> Shape:
    return {"gap": math.exp(rng.uniform(math.log(1e-4), math.log(1.5e-3)))}


def _turn(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(play_gap=shape["gap"] * severity, play_turn=1.0)


def _seal_shape(rng: Generator, _: Context) -> Shape:
    return {
        "stribeck": rng.uniform(1.05, 1.4), "speed": rng.uniform(0.005, 0.03), "length": rng.uniform(5e-5, 2e-4),
        "pressure": rng.uniform(0.1, 0.4),
    }  # fmt: skip


def _seal(shape: Shape, force: float, pressure: float) -> Changes:
    return set_parameters(
        seal_force=force, seal_stribeck=shape["stribeck"], seal_speed=shape["speed"], seal_length=shape["length"],
        seal_pressure=pressure,
    )  # fmt: skip


def _seal_lugre(severity: float, shape: Shape, _: Context) -> Changes:
    return _seal(shape, 25.0 * severity, 0.0)


def _seal_pressure(severity: float, shape: Shape, _: Context) -> Changes:
    return _seal(shape, 22.0 * severity, shape["pressure"])


def _damper(
    name: str,
    effect: str,
    draw: Draw,
    build: Build,
    span: tuple[float, float],
    bingham: bool = False,
) -> FaultScenario:
    return FaultScenario(name, f"damper.{effect}", "damper", draw, build, span, bingham)


SCENARIOS = (
    _damper("fade-arrhenius", "thermal_fade", _fade_shape, _arrhenius, (0.1, 4.0)),
    _damper("fade-power", "thermal_fade", _fade_shape, _power_fade, (0.1, 4.0)),
    _damper("gas-polytropic", "gas_spring", _gas_shape, _polytropic, (0.02, 4.0)),
    _damper("gas-accumulator", "gas_spring", _gas_shape, _accumulator, (0.02, 4.0)),
    _damper("asymmetry-all", "asymmetry", _asymmetry_shape, _asymmetry_both, (0.05, 6.0)),
    _damper("asymmetry-viscous", "asymmetry", _asymmetry_shape, _asymmetry_viscous, (0.05, 5.0)),
    _damper("preyield-dahl", "preyield_hysteresis", _preyield_shape, _dahl, (0.02, 15.0), bingham=True),
    _damper("preyield-lag", "preyield_hysteresis", _preyield_shape, _fluid_lag, (0.05, 8.0), bingham=True),
    _damper("saturation-froehlich", "magnetic_saturation", draw_nothing, _froehlich, (0.05, 8.0)),
    _damper("saturation-langevin", "magnetic_saturation", draw_nothing, _langevin, (0.1, 6.0)),
    _damper("remanence-relays", "remanence", _relay_shape, _relays, (0.05, 3.5)),
    _damper("remanence-decay", "remanence", _magnet_shape, _magnet, (0.05, 6.0)),
    _damper("play-contact", "free_play", _mount_shape, _play, (0.005, 6.0)),
    _damper("play-air", "free_play", _mount_shape, _air, (0.005, 6.0)),
    _damper("play-turn", "free_play", _gap_shape, _turn, (0.8, 1.2)),
    _damper("seal-lugre", "seal_friction", _seal_shape, _seal_lugre, (0.05, 6.0)),
    _damper("seal-pressure", "seal_friction", _seal_shape, _seal_pressure, (0.05, 6.0)),
)
