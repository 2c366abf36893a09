"""Truth forms of the damper's effects; equations in `damper_physics`."""

from __future__ import annotations

import math

from numpy.random import Generator

from seatsim.blind.truth.truth import Build, Changes, Context, Draw, Shape, Truth, slots


def _fade_shape(rng: Generator, _: Context) -> Shape:
    return {
        "yield": rng.uniform(0.35, 1.0), "fluid": rng.uniform(25.0, 90.0), "body": rng.uniform(120.0, 400.0),
        "tau": rng.uniform(1.0, 5.0), "gap": rng.uniform(1.5, 4.0), "air": rng.uniform(0.4, 1.5),
    }  # fmt: skip


def _heat(q: Shape) -> dict[str, float]:
    names = {"heat_fluid": "fluid", "heat_body": "body", "tau_thermo": "tau", "h_gap": "gap", "h_air": "air"}
    return {slot: q[name] for slot, name in names.items()}


def _arrhenius(s: float, q: Shape, _: Context) -> Changes:
    return slots(fade_form=1.0, fade_visc=1.1 * s, fade_yield=0.004 * q["yield"] * s, **_heat(q))


def _power_fade(s: float, q: Shape, _: Context) -> Changes:
    return slots(fade_form=2.0, fade_visc=0.012 * s, fade_yield=1.3 * q["yield"] * s, **_heat(q))


def _gas_shape(rng: Generator, _: Context) -> Shape:
    return {"length": rng.uniform(0.09, 0.2), "n": rng.uniform(1.05, 1.4), "rate": rng.uniform(4.0, 14.0)}


def _polytropic(s: float, q: Shape, _: Context) -> Changes:
    return slots(gas_form=1.0, gas_force=60.0 * s, gas_length=q["length"], gas_exponent=q["n"])


def _accumulator(s: float, q: Shape, _: Context) -> Changes:
    return slots(gas_form=2.0, gas_force=45.0 * s, gas_rate=45.0 * q["rate"] * s, gas_length=q["length"])


def _asymmetry_shape(rng: Generator, _: Context) -> Shape:
    return {
        "sign": float(rng.choice([-1.0, 1.0])), "back": rng.uniform(0.0, 0.8), "mix": rng.uniform(0.5, 1.2),
        "speed": rng.uniform(0.01, 0.05),
    }  # fmt: skip


def _asymmetry_both(s: float, q: Shape, _: Context) -> Changes:
    up, down = 0.15 * s * q["sign"], -0.15 * s * q["sign"] * q["back"]
    return slots(
        asym_visc_up=max(up * q["mix"], -0.9), asym_visc_down=max(down * q["mix"], -0.9), asym_yield_up=max(up, -0.9),
        asym_yield_down=max(down, -0.9), asym_speed=q["speed"],
    )  # fmt: skip


def _asymmetry_viscous(s: float, q: Shape, _: Context) -> Changes:
    return slots(asym_visc_up=0.35 * s, asym_visc_down=max(-0.35 * s * q["back"], -0.9), asym_speed=q["speed"])


def _preyield_shape(rng: Generator, _: Context) -> Shape:
    return {"length": rng.uniform(1e-4, 5e-4), "tau": rng.uniform(0.002, 0.006)}


def _dahl(s: float, q: Shape, _: Context) -> Changes:
    return slots(pre_share=min(s, 1.0), pre_length=q["length"] * max(s, 1.0))


def _fluid_lag(s: float, q: Shape, _: Context) -> Changes:
    return slots(pre_share=min(s, 1.0), pre_tau=q["tau"] * max(s, 1.0))


def _no_shape(rng: Generator, _: Context) -> Shape:
    return {}


def _froehlich(s: float, q: Shape, _: Context) -> Changes:
    return slots(sat_froehlich=0.3 * s)


def _langevin(s: float, q: Shape, _: Context) -> Changes:
    return slots(sat_langevin=0.6 * s)


def _relay_shape(rng: Generator, _: Context) -> Shape:
    return {"width": rng.uniform(0.15, 0.5)}


def _relays(s: float, q: Shape, _: Context) -> Changes:
    return slots(rem_relay=min(0.4 * s, 0.95), rem_width=q["width"] * max(0.4 * s / 0.95, 1.0) ** 0.7)


def _magnet_shape(rng: Generator, _: Context) -> Shape:
    return {"tau": rng.uniform(0.25, 1.5)}


def _magnet(s: float, q: Shape, _: Context) -> Changes:
    return slots(rem_gain=min(0.15 * s, 0.9), rem_tau=q["tau"])


def _mount_shape(rng: Generator, _: Context) -> Shape:
    return {"stiffness": rng.uniform(4e6, 5.5e6)}


def _play(s: float, q: Shape, _: Context) -> Changes:
    return slots(play_gap=0.0006 * s, mount_k=q["stiffness"])


def _air(s: float, q: Shape, _: Context) -> Changes:
    return slots(play_air=0.0004 * s, mount_k=q["stiffness"])


def _gap_shape(rng: Generator, _: Context) -> Shape:
    return {"gap": math.exp(rng.uniform(math.log(1e-4), math.log(1.5e-3)))}


def _turn(s: float, q: Shape, _: Context) -> Changes:
    return slots(play_gap=q["gap"] * s, play_turn=1.0)


def _seal_shape(rng: Generator, _: Context) -> Shape:
    return {
        "stribeck": rng.uniform(1.05, 1.4), "speed": rng.uniform(0.005, 0.03), "length": rng.uniform(5e-5, 2e-4),
        "pressure": rng.uniform(0.1, 0.4),
    }  # fmt: skip


def _seal(q: Shape, force: float, pressure: float) -> Changes:
    return slots(
        seal_force=force, seal_stribeck=q["stribeck"], seal_speed=q["speed"], seal_length=q["length"],
        seal_pressure=pressure,
    )  # fmt: skip


def _seal_lugre(s: float, q: Shape, _: Context) -> Changes:
    return _seal(q, 25.0 * s, 0.0)


def _seal_pressure(s: float, q: Shape, _: Context) -> Changes:
    return _seal(q, 22.0 * s, q["pressure"])


def _damper(
    name: str,
    effect: str,
    draw: Draw,
    build: Build,
    span: tuple[float, float],
    bingham: bool = False,
    warm: bool = False,
) -> Truth:
    needs = ("damper_temperature",) if warm else ()
    return Truth(name, f"damper.{effect}", "damper", draw, build, span, bingham, warm, needs)


TRUTHS = (
    _damper("fade-arrhenius", "thermal_fade", _fade_shape, _arrhenius, (0.1, 4.0), warm=True),
    _damper("fade-power", "thermal_fade", _fade_shape, _power_fade, (0.1, 4.0), warm=True),
    _damper("gas-polytropic", "gas_spring", _gas_shape, _polytropic, (0.02, 4.0)),
    _damper("gas-accumulator", "gas_spring", _gas_shape, _accumulator, (0.02, 4.0)),
    _damper("asymmetry-all", "asymmetry", _asymmetry_shape, _asymmetry_both, (0.05, 6.0)),
    _damper("asymmetry-viscous", "asymmetry", _asymmetry_shape, _asymmetry_viscous, (0.05, 5.0)),
    _damper("preyield-dahl", "preyield_hysteresis", _preyield_shape, _dahl, (0.02, 15.0), bingham=True),
    _damper("preyield-lag", "preyield_hysteresis", _preyield_shape, _fluid_lag, (0.05, 8.0), bingham=True),
    _damper("saturation-froehlich", "magnetic_saturation", _no_shape, _froehlich, (0.05, 8.0)),
    _damper("saturation-langevin", "magnetic_saturation", _no_shape, _langevin, (0.1, 6.0)),
    _damper("remanence-relays", "remanence", _relay_shape, _relays, (0.05, 3.5)),
    _damper("remanence-decay", "remanence", _magnet_shape, _magnet, (0.05, 6.0)),
    _damper("play-contact", "free_play", _mount_shape, _play, (0.005, 6.0)),
    _damper("play-air", "free_play", _mount_shape, _air, (0.005, 6.0)),
    _damper("play-turn", "free_play", _gap_shape, _turn, (0.8, 1.2)),
    _damper("seal-lugre", "seal_friction", _seal_shape, _seal_lugre, (0.05, 6.0)),
    _damper("seal-pressure", "seal_friction", _seal_shape, _seal_pressure, (0.05, 6.0)),
)
