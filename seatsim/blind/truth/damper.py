"""Force of the true damper: the contract's two models as the nominal part, what a real one does besides, its mount.

Nominal (contract, section 2; N, m/s, A):  `F = (c_a + c_b i) v + k0 (x - x0) + (y_a + y_b i) z + f0`, with z the
Bouc-Wen variable or `tanh(v / v_ref)`. Everything else is zero, or one, while its parameter is zero. It is mounted
rigidly, with play at its ends, or with air that is squeezed before it carries.
"""

import math

from seatsim.blind.truth import coil, state
from seatsim.blind.truth.state import FASTEST, MICRO_DAMPING, RigParameters, bristle_rate, compiled
from seatsim.schema.arrays import Array

_LEAST_GAS_COLUMN = 0.2
"""Of the gas column: the travel of a seat never compresses it further, and the power stays finite."""
_CAVITY_SLOPE = 0.15
"""Share of the force above the opening of the cavity that the fluid still carries."""
_CAVITY_LOSS = 0.9
"""Largest share of the force that is lost while the cavity closes again."""
_CAVITY_SCALE = 1e-3
"""m of open stroke over which that loss sets in."""
_SEAL_LOAD = 300.0
"""N of damper force that presses the seal by one `seal_pressure`."""
_LARGEST_SEAL_LOAD = 3.0
"""Loads beyond this press the seal no further."""
_CLOSE_ENOUGH = 0.05
"""N; a fiftieth of the load cell's noise."""
_NEWTON_STEPS = 4
"""From the last solution one or two are enough, unless the motion turns or meets the contact."""
_DIFFERENCE = 1e-4
"""m/s, over which Newton takes the slope."""
_LEAST_SLOPE = 50.0
"""N s/m; below the damper's viscous damping, so that a flat stretch of the curve throws the guess nowhere."""
_LARGEST_CHANGE = 0.5
"""m/s of one Newton step."""
_FASTEST_PISTON = 4.0
"""m/s; bracket of false position, beyond any seat."""
_BRACKET_STEPS = 40


@compiled
def _yield_variable(y: Array, v: float, p: RigParameters) -> float:
    """Return the yield variable z: Bouc-Wen state, `tanh(v / v_ref)`, or a hysteretic stand-in for the latter."""
    if p.is_bingham == 0.0:
        return float(y[state.Z])
    nominal = math.tanh(v / p.v_ref)
    if p.preyield_share == 0.0:
        return nominal
    late = y[state.PREYIELD] if p.preyield_time == 0.0 else math.tanh(y[state.PREYIELD] / p.v_ref)
    return nominal + p.preyield_share * (late - nominal)


@compiled
def gas_force(x: float, p: RigParameters) -> float:
    """Return the force of the accumulator: polytropic `-F (1 + x / L)^-n`, or preload with a falling stiffness."""
    if p.gas_law == 2.0:
        return -p.gas_force + p.gas_rate * (x - 0.5 * x * x / p.gas_length)
    if p.gas_force == 0.0:
        return 0.0
    return float(-p.gas_force * max(1.0 + x / p.gas_length, _LEAST_GAS_COLUMN) ** (-p.gas_exponent))


@compiled
def _viscous_damping(y: Array, v: float, p: RigParameters) -> float:
    """Return the viscous damping at the fluid's temperature, the direction and the speed, N s/m."""
    viscous = p.c_a + p.c_b * y[state.CURRENT]
    if p.fade_law != 0.0:
        viscous *= coil.viscous_factor(y[state.T_FLUID], p)
    up = 0.5 * (1.0 + math.tanh(v / p.asym_speed))
    viscous *= 1.0 + p.asym_viscous_up * up + p.asym_viscous_down * (1.0 - up)
    if p.thinning_power != 0.0:
        viscous *= (1.0 + (v / p.thinning_speed) ** 2) ** (-0.5 * p.thinning_power)
    return float(viscous)


@compiled
def _yield_force(y: Array, memory: Array, z: float, p: RigParameters) -> float:
    """Return the yield force at the fluid's temperature and the direction of z, N."""
    strength = p.y_a + p.y_b * coil.yield_current(y, memory, p)
    if p.fade_law != 0.0:
        strength *= coil.yield_factor(y[state.T_FLUID], p)
    up = 0.5 * (1.0 + min(max(z, -1.0), 1.0))
    return float(strength * (1.0 + p.asym_yield_up * up + p.asym_yield_down * (1.0 - up)))


@compiled
def _main_force(y: Array, memory: Array, x: float, v: float, p: RigParameters) -> float:
    """Return the force of fluid and field before seal and gas, N."""
    z = _yield_variable(y, v, p)
    force = _viscous_damping(y, v, p) * v + p.k0 * (x - p.x0) + _yield_force(y, memory, z, p) * z + p.f0
    force += p.orifice_damping * v * abs(v) + p.field_stiffness * y[state.CURRENT] * x
    if p.bypass_share != 0.0:
        force *= 1.0 - p.bypass_share * math.exp(-((x / p.bypass_length) ** 2))
    if p.cavitation_force > 0.0:
        if v > 0.0 and force > p.cavitation_force:
            force = p.cavitation_force + _CAVITY_SLOPE * (force - p.cavitation_force)
        elif v < 0.0:
            force *= 1.0 - _CAVITY_LOSS * math.tanh(memory[state.CAVITY_VOLUME] / _CAVITY_SCALE)
    return float(force)


@compiled
def _write_yield_rates(y: Array, rates: Array, v: float, p: RigParameters) -> None:
    """Write the rate of the yield variable.

    Bouc-Wen: `z' = A v - beta v |z|^n - gamma |v| z |z|^(n-1)`; Dahl-like: `u' = |v| / length (tanh(v / v_ref) - u)`;
    viscoelastic: the speed that the fluid feels lags the piston's by `preyield_time`.
    """
    if p.is_bingham == 0.0:
        z = y[state.Z]
        # the two common exponents without a power, which would be the most expensive operation of the loop
        size = 1.0
        if p.n == 2.0:
            size = abs(z)
        elif p.n != 1.0:
            size = abs(z) ** (p.n - 1.0)
        rates[state.Z] = p.A * v - p.beta * v * size * abs(z) - p.gamma * abs(v) * z * size
    elif p.preyield_share != 0.0 and p.preyield_time == 0.0:
        # a tenth of v_ref^2 keeps the state moving at rest; without it z would stay where the motion stopped
        rate = min(math.sqrt(v * v + 0.1 * p.v_ref * p.v_ref) / p.preyield_length, FASTEST)
        rates[state.PREYIELD] = rate * (math.tanh(v / p.v_ref) - y[state.PREYIELD])
    elif p.preyield_share != 0.0:
        rates[state.PREYIELD] = (v - y[state.PREYIELD]) / p.preyield_time


@compiled
def seal_force(y: Array, rates: Array, v: float, force: float, p: RigParameters) -> float:
    """Return the friction of the seal, which the damper's `force` presses on, N, and write the rate of its bristle."""
    rate = bristle_rate(y[state.SEAL], v, p.seal_length, p.seal_stribeck, p.seal_speed)
    rates[state.SEAL] = rate
    sticking = math.exp(-((v / p.seal_speed) ** 2))
    level = p.seal_force * (1.0 + p.seal_pressure * min(abs(force) / _SEAL_LOAD, _LARGEST_SEAL_LOAD))
    return float(level * (y[state.SEAL] + MICRO_DAMPING * sticking * rate))


@compiled
def update_cavity(y: Array, memory: Array, x: float, v: float, h: float, p: RigParameters) -> None:
    """Carry the open stroke of the cavity over one step: it opens in extension and closes in compression."""
    force = _main_force(y, memory, x, v, p)
    if v > 0.0 and force >= p.cavitation_force:
        memory[state.CAVITY_VOLUME] += p.cavitation_fill * v * h * (1.0 - p.cavitation_force / force)
    elif v < 0.0:
        memory[state.CAVITY_VOLUME] = max(memory[state.CAVITY_VOLUME] + v * h, 0.0)


@compiled
def _mount_force(u: float, p: RigParameters) -> float:
    """Return the force of a mount stretched by u: contact outside a gap, or air that is squeezed before it carries."""
    if p.play_air > 0.0:
        return p.mount_stiffness * u * u * u / (u * u + p.play_air * p.play_air)
    depth = abs(u) - 0.5 * p.play_gap
    if depth <= 0.0:
        return 0.0
    return p.mount_stiffness * depth if u > 0.0 else -p.mount_stiffness * depth


@compiled
def _piston_speed(y: Array, memory: Array, x: float, wanted: float, p: RigParameters) -> float:
    """Return the speed at which the damper bears the force `wanted`, m/s.

    Newton from the last solution; where that does not settle in a few steps, false position (Illinois), which cannot
    leave its bracket.
    """
    guess: float = memory[state.V_PISTON]
    for _ in range(_NEWTON_STEPS):
        f = _main_force(y, memory, x, guess, p) - wanted
        if abs(f) < _CLOSE_ENOUGH:
            memory[state.V_PISTON] = guess
            return guess
        # multiplied by 1 / _DIFFERENCE
        slope = (_main_force(y, memory, x, guess + _DIFFERENCE, p) - wanted - f) * 1e4
        guess -= min(max(f / max(slope, _LEAST_SLOPE), -_LARGEST_CHANGE), _LARGEST_CHANGE)
    guess = _bracketed_speed(y, memory, x, wanted, guess, p)
    memory[state.V_PISTON] = guess
    return guess


@compiled
def _bracketed_speed(y: Array, memory: Array, x: float, wanted: float, guess: float, p: RigParameters) -> float:
    """Return the same by false position from a guess, halving the residual of the end that stays (Illinois)."""
    low, high = -_FASTEST_PISTON, _FASTEST_PISTON
    f_low = _main_force(y, memory, x, low, p) - wanted
    f_high = _main_force(y, memory, x, high, p) - wanted
    for _ in range(_BRACKET_STEPS):
        f = _main_force(y, memory, x, guess, p) - wanted
        if abs(f) < _CLOSE_ENOUGH:
            break
        if f > 0.0:
            high, f_high, f_low = guess, f, 0.5 * f_low
        else:
            low, f_low, f_high = guess, f, 0.5 * f_high
        guess = high - f_high * (high - low) / (f_high - f_low)
    return guess


@compiled
def damper_force(y: Array, rates: Array, memory: Array, x: float, speed: float, p: RigParameters) -> float:
    """Return Fd at the load cell, N (positive opposes extension), and write the rates of its own states.

    `speed` is that of the mounts; the piston has the same, unless there is play. With `play_turn` the damper rests,
    and keeps its state, from where the motion turns until the gap is crossed. Otherwise the piston moves as fast as
    makes its force equal to the mount's.
    """
    turning = p.play_turn != 0.0 and p.play_gap > 0.0
    loose = not turning and (p.play_gap > 0.0 or p.play_air > 0.0)
    stretch = y[state.MOUNT]
    resting = turning and (abs(stretch) < 0.5 * p.play_gap or stretch * speed <= 0.0)
    force = 0.0
    v = 0.0 if resting else speed
    if loose:
        force = _mount_force(stretch, p)
        v = _piston_speed(y, memory, x, force, p)
    if turning or loose:
        rates[state.MOUNT] = speed - v
    _write_yield_rates(y, rates, v, p)
    if not (loose or resting):
        force = _main_force(y, memory, x, v, p)
    coil.write_magnetisation_rate(y, rates, p)
    if p.seal_force != 0.0:
        force += seal_force(y, rates, v, force, p)
    # the gas stores its work, so the fluid is heated by the force before it
    coil.write_heat_rates(y, rates, force * v, p)
    return force + gas_force(x, p)
