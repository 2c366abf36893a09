"""The true damper as it is mounted: rigidly, with play at its ends, or with air that is squeezed before it carries."""

from __future__ import annotations

from seatsim.blind.truth.physics import state
from seatsim.blind.truth.physics.compiled import compiled
from seatsim.blind.truth.physics.damper import gas_force, main_force, seal_force, write_yield_rates
from seatsim.blind.truth.physics.magnetisation import write_magnetisation_rate
from seatsim.blind.truth.physics.parameters import RigParameters
from seatsim.blind.truth.physics.temperature import write_heat_rates
from seatsim.schema.arrays import Array

CLOSE_ENOUGH = 0.05
"""N; a fiftieth of the load cell's noise."""
NEWTON_STEPS = 4
"""From the last solution one or two are enough, unless the motion turns or meets the contact."""
DIFFERENCE = 1e-4
"""m/s, over which Newton takes the slope."""
LEAST_SLOPE = 50.0
"""N s/m; below the damper's viscous damping, so that a flat stretch of the curve throws the guess nowhere."""
LARGEST_CHANGE = 0.5
"""m/s of one Newton step."""
FASTEST_PISTON = 4.0
"""m/s; bracket of false position, beyond any seat."""
BRACKET_STEPS = 40


@compiled
def mount_force(u: float, p: RigParameters) -> float:
    """Return the force of a mount stretched by u: contact outside a gap, or air that is squeezed before it carries."""
    if p.play_air > 0.0:
        return p.mount_stiffness * u * u * u / (u * u + p.play_air * p.play_air)
    depth = abs(u) - 0.5 * p.play_gap
    if depth <= 0.0:
        return 0.0
    return p.mount_stiffness * depth if u > 0.0 else -p.mount_stiffness * depth


@compiled
def piston_speed(y: Array, memory: Array, x: float, wanted: float, p: RigParameters) -> float:
    """Return the speed at which the damper bears the force `wanted`, m/s.

    Newton from the last solution; where that does not settle in a few steps, false position (Illinois), which cannot
    leave its bracket.
    """
    guess: float = memory[state.V_PISTON]
    for _ in range(NEWTON_STEPS):
        f = main_force(y, memory, x, guess, p) - wanted
        if abs(f) < CLOSE_ENOUGH:
            memory[state.V_PISTON] = guess
            return guess
        # multiplied by 1 / DIFFERENCE
        slope = (main_force(y, memory, x, guess + DIFFERENCE, p) - wanted - f) * 1e4
        guess -= min(max(f / max(slope, LEAST_SLOPE), -LARGEST_CHANGE), LARGEST_CHANGE)
    guess = bracketed_speed(y, memory, x, wanted, guess, p)
    memory[state.V_PISTON] = guess
    return guess


@compiled
def bracketed_speed(y: Array, memory: Array, x: float, wanted: float, guess: float, p: RigParameters) -> float:
    """Return the same by false position from a guess, halving the residual of the end that stays (Illinois)."""
    low, high = -FASTEST_PISTON, FASTEST_PISTON
    f_low = main_force(y, memory, x, low, p) - wanted
    f_high = main_force(y, memory, x, high, p) - wanted
    for _ in range(BRACKET_STEPS):
        f = main_force(y, memory, x, guess, p) - wanted
        if abs(f) < CLOSE_ENOUGH:
            break
        if f > 0.0:
            high, f_high, f_low = guess, f, 0.5 * f_low
        else:
            low, f_low, f_high = guess, f, 0.5 * f_high
        guess = high - f_high * (high - low) / (f_high - f_low)
    return guess


@compiled
def rests(stretch: float, speed: float, p: RigParameters) -> bool:
    """Tell whether a damper with play rests: its motion has turned and the gap is not crossed yet."""
    return abs(stretch) < 0.5 * p.play_gap or stretch * speed <= 0.0


@compiled
def damper_force(y: Array, rates: Array, memory: Array, x: float, speed: float, p: RigParameters) -> float:
    """Return Fd at the load cell, N (positive opposes extension), and write the rates of its own states.

    `speed` is that of the mounts; the piston has the same, unless there is play. With `play_turn` the damper rests,
    and keeps its state, from where the motion turns until the gap is crossed. Otherwise the piston moves as fast as
    makes its force equal to the mount's.
    """
    turning = p.play_turn != 0.0 and p.play_gap > 0.0
    loose = not turning and (p.play_gap > 0.0 or p.play_air > 0.0)
    resting = turning and rests(y[state.MOUNT], speed, p)
    force = 0.0
    v = 0.0 if resting else speed
    if loose:
        force = mount_force(y[state.MOUNT], p)
        v = piston_speed(y, memory, x, force, p)
    if turning or loose:
        rates[state.MOUNT] = speed - v
    write_yield_rates(y, rates, v, p)
    if not (loose or resting):
        force = main_force(y, memory, x, v, p)
    write_magnetisation_rate(y, rates, p)
    if p.seal_force != 0.0:
        force += seal_force(y, rates, v, force, p)
    # the gas stores its work, so the fluid is heated by the force before it
    write_heat_rates(y, rates, force * v, p)
    return force + gas_force(x, p)
