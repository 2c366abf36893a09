"""Force of the true damper: the contract's two models as the nominal part, and what a real one does besides.

Nominal (contract, section 2; N, m/s, A):  `F = (c_a + c_b i) v + k0 (x - x0) + (y_a + y_b i) z + f0`, with z the
Bouc-Wen variable or `tanh(v / v_ref)`. Everything else is zero, or one, while its parameter is zero.
"""

from __future__ import annotations

import math

from seatsim.blind.truth import slots as s
from seatsim.blind.truth.compiled import Parameters, compiled
from seatsim.blind.truth.slots import Array

FASTEST = 15000.0
"""Bound on the rate of a bristle, 1/s, so that the step resolves it."""


@compiled
def yield_current(y: Array, mem: Array, p: Parameters) -> float:
    """Return the current that the yield force feels, A.

    Saturation: Froehlich `i / (1 + b i)` or Langevin `I (coth(3 i / I) - I / (3 i))`. Remanence: mean of relays with
    several widths (Preisach), or a magnetisation that rises at once and decays slowly.
    """
    i: float = y[s.CUR]
    felt = i
    if p.rem_relay != 0.0:
        felt += p.rem_relay * (mem[s.RELAYS_MEAN] - i)
    if p.rem_gain != 0.0:
        felt += p.rem_gain * (y[s.MAGNET] - i)
    if p.sat_froehlich != 0.0:
        felt = felt / (1.0 + p.sat_froehlich * max(felt, 0.0))
    if p.sat_langevin != 0.0:
        u = 3.0 * felt * p.sat_langevin
        if u > 1e-3:
            felt = (1.0 / math.tanh(u) - 1.0 / u) / p.sat_langevin
    return felt


@compiled
def viscous_factor(t: float, p: Parameters) -> float:
    """Return viscosity at `t` degC over that at 20: Arrhenius `exp(B (1/T - 1/T20))` or `1 / (1 + b (t - 20))`."""
    if p.fade_form == 1.0:
        return math.exp(p.fade_visc * (1000.0 / (t + 273.15) - 1000.0 / 293.15))
    return 1.0 / (1.0 + p.fade_visc * max(t - 20.0, -15.0))


@compiled
def yield_factor(t: float, p: Parameters) -> float:
    """Return yield stress at `t` degC over that at 20: exponential or a power of the absolute temperature."""
    if p.fade_form == 1.0:
        return math.exp(-p.fade_yield * (t - 20.0))
    return float(((t + 273.15) / 293.15) ** (-p.fade_yield))


@compiled
def shape(y: Array, v: float, p: Parameters) -> float:
    """Return the yield variable z: Bouc-Wen state, `tanh(v / v_ref)`, or a hysteretic stand-in for the latter."""
    if p.is_bingham == 0.0:
        return float(y[s.Z])
    nominal = math.tanh(v / p.v_ref)
    if p.pre_share == 0.0:
        return nominal
    late = y[s.PRE] if p.pre_tau == 0.0 else math.tanh(y[s.PRE] / p.v_ref)
    return nominal + p.pre_share * (late - nominal)


@compiled
def gas_force(x: float, p: Parameters) -> float:
    """Return the force of the accumulator: polytropic `-F (1 + x / L)^-n`, or preload with a falling stiffness."""
    if p.gas_form == 2.0:
        return -p.gas_force + p.gas_rate * (x - 0.5 * x * x / p.gas_length)
    if p.gas_force == 0.0:
        return 0.0
    return float(-p.gas_force * max(1.0 + x / p.gas_length, 0.2) ** (-p.gas_exponent))


@compiled
def mount_force(u: float, p: Parameters) -> float:
    """Return the force of a mount stretched by u: contact outside a gap, or air that is squeezed before it carries."""
    if p.play_air > 0.0:
        return p.mount_k * u * u * u / (u * u + p.play_air * p.play_air)
    depth = abs(u) - 0.5 * p.play_gap
    if depth <= 0.0:
        return 0.0
    return p.mount_k * depth if u > 0.0 else -p.mount_k * depth


@compiled
def main_force(y: Array, mem: Array, x: float, v: float, p: Parameters) -> float:
    """Return the force of fluid and field before seal and gas, N."""
    i = y[s.CUR]
    z = shape(y, v, p)
    viscous = p.c_a + p.c_b * i
    strength = p.y_a + p.y_b * yield_current(y, mem, p)
    if p.fade_form != 0.0:
        viscous *= viscous_factor(y[s.T_FLUID], p)
        strength *= yield_factor(y[s.T_FLUID], p)
    up = 0.5 * (1.0 + math.tanh(v / p.asym_speed))
    viscous *= 1.0 + p.asym_visc_up * up + p.asym_visc_down * (1.0 - up)
    up = 0.5 * (1.0 + min(max(z, -1.0), 1.0))
    strength *= 1.0 + p.asym_yield_up * up + p.asym_yield_down * (1.0 - up)
    if p.thin_power != 0.0:
        viscous *= (1.0 + (v / p.thin_speed) ** 2) ** (-0.5 * p.thin_power)
    force = viscous * v + p.k0 * (x - p.x0) + strength * z + p.f0
    force += p.orifice * v * abs(v) + p.mag_stiffness * i * x
    if p.bypass != 0.0:
        force *= 1.0 - p.bypass * math.exp(-((x / p.bypass_length) ** 2))
    if p.cav_force > 0.0:
        if v > 0.0 and force > p.cav_force:
            force = p.cav_force + 0.15 * (force - p.cav_force)
        elif v < 0.0:
            force *= 1.0 - 0.9 * math.tanh(mem[s.VOLUME] / 1e-3)
    return float(force)


@compiled
def piston_speed(y: Array, mem: Array, x: float, wanted: float, p: Parameters) -> float:
    """Return the speed at which the damper bears the force `wanted` (Newton, else false position), m/s."""
    guess: float = mem[s.V_PISTON]
    for _ in range(4):
        f = main_force(y, mem, x, guess, p) - wanted
        if abs(f) < 0.05:
            mem[s.V_PISTON] = guess
            return guess
        slope = (main_force(y, mem, x, guess + 1e-4, p) - wanted - f) * 1e4
        guess -= min(max(f / max(slope, 50.0), -0.5), 0.5)
    low, high = -4.0, 4.0
    f_low = main_force(y, mem, x, low, p) - wanted
    f_high = main_force(y, mem, x, high, p) - wanted
    for _ in range(40):
        f = main_force(y, mem, x, guess, p) - wanted
        if abs(f) < 0.05:
            break
        if f > 0.0:
            high, f_high, f_low = guess, f, 0.5 * f_low
        else:
            low, f_low, f_high = guess, f, 0.5 * f_high
        guess = high - f_high * (high - low) / (f_high - f_low)
    mem[s.V_PISTON] = guess
    return guess


@compiled
def bristle_rate(state: float, v: float, length: float, stribeck: float, speed: float) -> float:
    """Return the rate of a LuGre bristle in shares of the sliding force: `(v - |v| s / G(v)) / length`, 1/s."""
    level = 1.0 + (stribeck - 1.0) * math.exp(-((v / speed) ** 2))
    rate = min(abs(v) / length, FASTEST)
    return rate * ((1.0 if v > 0.0 else -1.0) - state / level)


@compiled
def damper_force(y: Array, dy: Array, mem: Array, x: float, speed: float, p: Parameters) -> float:
    """Return Fd at the load cell, N (positive opposes extension), and write the rates of its own states.

    With `play_turn` the damper rests, and keeps its state, from where the motion turns until the gap is crossed.
    """
    force = 0.0
    turning = p.play_turn != 0.0 and p.play_gap > 0.0
    resting = turning and (abs(y[s.MOUNT]) < 0.5 * p.play_gap or y[s.MOUNT] * speed <= 0.0)
    loose = not turning and (p.play_gap > 0.0 or p.play_air > 0.0)
    v = 0.0 if resting else speed
    if turning:
        dy[s.MOUNT] = speed - v
    elif loose:
        force = mount_force(y[s.MOUNT], p)
        v = piston_speed(y, mem, x, force, p)
        dy[s.MOUNT] = speed - v
    if p.is_bingham == 0.0:
        z = y[s.Z]
        size = abs(z) if p.n == 1.0 else abs(z) ** (p.n - 1.0)
        if p.n == 2.0:
            size = abs(z)
        dy[s.Z] = p.A * v - p.beta * v * size * abs(z) - p.gamma * abs(v) * z * size
    elif p.pre_share != 0.0 and p.pre_tau == 0.0:
        rate = min(math.sqrt(v * v + 0.1 * p.v_ref * p.v_ref) / p.pre_length, FASTEST)
        dy[s.PRE] = rate * (math.tanh(v / p.v_ref) - y[s.PRE])
    elif p.pre_share != 0.0:
        dy[s.PRE] = (v - y[s.PRE]) / p.pre_tau
    if not (loose or resting):
        force = main_force(y, mem, x, v, p)
    if p.rem_gain != 0.0:
        rise = y[s.CUR] - y[s.MAGNET]
        dy[s.MAGNET] = rise * 200.0 if rise > 0.0 else rise * (0.4 - 2.0 * rise) / p.rem_tau
    if p.seal_force != 0.0:
        rate = bristle_rate(y[s.SEAL], v, p.seal_length, p.seal_stribeck, p.seal_speed)
        dy[s.SEAL] = rate
        sticky = math.exp(-((v / p.seal_speed) ** 2))
        level = p.seal_force * (1.0 + p.seal_pressure * min(abs(force) / 300.0, 3.0))
        force += level * (y[s.SEAL] + 0.001 * sticky * rate)
    scaling = force * v
    force += gas_force(x, p)
    flow = p.h_gap * (y[s.T_FLUID] - y[s.T_BODY])
    dy[s.T_FLUID] = (abs(scaling) - flow) / p.heat_fluid
    dy[s.T_BODY] = (flow - p.h_air * (y[s.T_BODY] - p.t_ambient)) / p.heat_body
    dy[s.T_THERMO] = (y[s.T_BODY] - y[s.T_THERMO]) / p.tau_thermo
    return force


@compiled
def remember(y: Array, mem: Array, relays: Array, x: float, v: float, h: float, p: Parameters) -> None:
    """Carry cavity and relays over one step."""
    if p.cav_force > 0.0:
        force = main_force(y, mem, x, v, p)
        if v > 0.0 and force >= p.cav_force:
            mem[s.VOLUME] += p.cav_fill * v * h * (1.0 - p.cav_force / force)
        elif v < 0.0:
            mem[s.VOLUME] = max(mem[s.VOLUME] + v * h, 0.0)
    if p.rem_relay != 0.0:
        total = 0.0
        for k in range(s.RELAYS):
            half = 0.5 * p.rem_width * (0.4 + 1.2 * ((k * 7) % s.RELAYS) / s.RELAYS)
            centre = (k + 0.5) / s.RELAYS
            if y[s.CUR] > centre + half:
                relays[k] = 1.0
            elif y[s.CUR] < centre - half:
                relays[k] = 0.0
            total += relays[k]
        mem[s.RELAYS_MEAN] = total / s.RELAYS
