"""The true coil, from the command that the controller logs to the current that the yield force feels, A.

Nominal: `di/dt = rate (i_cmd - i)`, `0 <= i <= i_max`, the command held from its row until the next. A controller is
sampled at the rows: a schedule, on-off skyhook or static output feedback. Its `law` is a vector of six numbers: kind,
level (A), then what the kind needs. Behind the coil, its field saturates and stays, and the fluid warms up.
"""

import math

from seatsim.blind.truth import state
from seatsim.blind.truth.state import RigParameters, compiled
from seatsim.schema.arrays import Array

ROUNDING = 1e-6
"""Of a row: a time that lies on a row but for rounding counts as that row."""
_JITTER_SEED = 3.0
_LOWEST_LIMIT = 0.05
"""A; a supply that sags still delivers this."""
_SAG_TIME = 1.5
"""s, over which the supply averages the current that makes it sag."""
_DROPOUT_GRID = 1e-3
"""s; a dropout may begin once in each of these intervals, which are longer than any step of a simulation."""
_OFF = 0.02
"""A; below this target the driver is off and no voltage is left for the back EMF to reduce."""
_FALL_AT_LOW_CURRENT = 1.6
"""Weight of the slow fall at no current; it goes to zero at 1 A."""
SCHEDULE, SKYHOOK, FEEDBACK = 0.0, 1.0, 2.0
"""Kinds of law; numbers, because compiled code reads them from the vector."""
# The feedback's assumed damper model, by which it turns a force into a current: friction, N; viscous damping, N s/m;
# yield force, N/A; rise of the viscous damping with current, N s/(m A). Near the nominal damper and never exact, as in
# a real controller.
_FRICTION, _VISCOUS, _YIELD_GAIN, _VISCOUS_GAIN = 40.0, 250.0, 600.0, 350.0


@compiled
def _repeatable_noise(k: float, seed: float) -> float:
    """Return a number in 0..1 that depends on the whole number k and the seed alone (the usual hash of shaders).

    Compiled code draws no random numbers, so that a run is the same with any integration step in between.
    """
    value = math.sin(k * 12.9898 + seed * 78.233) * 43758.5453
    return value - math.floor(value)


@compiled
def held_command(commands: Array, time: float, interval: float, p: RigParameters) -> float:
    """Return the command that reaches the driver: held, `delay` late, with jitter from row to row."""
    if p.delay == 0.0:
        return float(commands[int(time / interval + ROUNDING)])
    late = p.delay
    if p.delay_jitter != 0.0:
        late *= 1.0 + p.delay_jitter * (2.0 * _repeatable_noise(math.floor(time / interval), _JITTER_SEED) - 1.0)
    row = math.floor((time - late) / interval + ROUNDING)
    return commands[row] if row >= 0 else 0.0


@compiled
def target_current(command: float, time: float, h: float, y: Array, memory: Array, p: RigParameters) -> float:
    """Return the current that the driver aims at: quantised, with a dead band, limited softly, with dropouts.

    The soft limit is `i / (1 + (i / limit)^n)^(1/n)`, with the limit lowered by the mean current where it sags.
    """
    target = min(max(command, 0.0), p.i_max)
    if p.command_quantum > 0.0:
        target = p.command_quantum * math.floor(target / p.command_quantum + 0.5)
    if p.dead_zone > 0.0:
        target = max(target - p.dead_zone, 0.0)
    if p.limit > 0.0:
        ceiling = max(p.limit - p.limit_sag * y[state.SAG], _LOWEST_LIMIT)
        target = target / (1.0 + (target / ceiling) ** p.limit_power) ** (1.0 / p.limit_power)
    if p.dropout_interval > 0.0 and _drops_out(time, h, memory, p):
        return 0.0
    return target


@compiled
def _drops_out(time: float, h: float, memory: Array, p: RigParameters) -> bool:
    """Tell whether the driver is off in this step; dropouts begin at random, `dropout_interval` apart on average.

    Where one may begin does not depend on the step, so that a coarse simulation and the recorded one have the same.
    """
    if memory[state.DROPOUT_LEFT] > 0.0:
        memory[state.DROPOUT_LEFT] -= h
        return True
    chance = _repeatable_noise(math.floor(time / _DROPOUT_GRID + ROUNDING), p.dropout_seed)
    if chance < _DROPOUT_GRID / p.dropout_interval:
        memory[state.DROPOUT_LEFT] = p.dropout_duration
    return False


@compiled
def _falling_rate(i: float, aim: float, p: RigParameters) -> float:
    """Return the rate of the coil, 1/s: lower while the current falls, at every current or mostly at low ones."""
    if p.fall_law == 1.0 and aim < i:
        return p.rate / (1.0 + p.fall_slow)
    if p.fall_law == 2.0 and aim < i:
        return p.rate / (1.0 + _FALL_AT_LOW_CURRENT * p.fall_slow * max(1.0 - i, 0.0))
    return p.rate


@compiled
def write_coil_rates(y: Array, rates: Array, target: float, v: float, p: RigParameters) -> None:
    """Write the rates of the coil's states: one pole, two poles, two branches, or a ringing regulator.

    The back EMF takes `back_emf |v|` off the current that the driver can force.
    """
    i = y[state.CURRENT]
    aim = target
    if p.back_emf != 0.0:
        aim = max(aim - p.back_emf * abs(v) * (1.0 if aim > _OFF else 0.0), 0.0)
    rate = _falling_rate(i, aim, p)
    if p.second_rate > 0.0:
        rates[state.CURRENT_2] = rate * (aim - y[state.CURRENT_2])
        rates[state.CURRENT] = p.second_rate * (y[state.CURRENT_2] - i)
    elif p.slow_share > 0.0:
        slow = p.slow_rate * (aim - y[state.CURRENT_2])
        fast = (i - p.slow_share * y[state.CURRENT_2]) / (1.0 - p.slow_share)
        rates[state.CURRENT_2] = slow
        rates[state.CURRENT] = (1.0 - p.slow_share) * rate * (aim - fast) + p.slow_share * slow
    elif p.ring_rate > 0.0:
        rates[state.CURRENT] = y[state.CURRENT_2]
        rates[state.CURRENT_2] = p.ring_rate * (p.ring_rate * (aim - i) - 2.0 * p.ring_damping * y[state.CURRENT_2])
    else:
        rates[state.CURRENT] = rate * (aim - i)
    if p.limit_sag > 0.0:
        rates[state.SAG] = (i - y[state.SAG]) / _SAG_TIME


@compiled
def command_of(law: Array, schedule: Array, row: int, y: Array, memory: Array, p: RigParameters) -> float:
    """Return the commanded current at a row, A.

    Skyhook (Karnopp 1974): full level where absolute and relative velocity have one sign, off below the relative speed
    `law[2]`. Feedback: the wanted force `g1 x + g2 v + g3 zs' + g4 zc'` over the yield force per ampere, where the
    damper can give it, else zero.
    """
    if law[0] == SCHEDULE:
        return float(min(max(schedule[row], 0.0), p.i_max))
    v = y[state.V]
    if law[0] == SKYHOOK:
        dead = law[2]
        # the frame's velocity has a dead band too, a tenth as wide, so that noise around rest switches nothing
        return law[1] if memory[state.V_FRAME] * v > dead * abs(v) * 0.1 and abs(v) > dead else 0.0
    wanted = law[2] * y[state.X] + law[3] * v + law[4] * memory[state.V_FRAME] + law[5] * memory[state.V_DRIVER]
    if wanted * v <= 0.0:
        return 0.0
    current = (abs(wanted) - _FRICTION - _VISCOUS * abs(v)) / (_YIELD_GAIN + _VISCOUS_GAIN * abs(v))
    # a controller logs and sends four decimals
    return float(round(min(max(current, 0.0), law[1]), 4))


_REFERENCE = 20.0
"""degC at which the nominal parameters hold."""
_ZERO = 273.15
"""K at 0 degC."""
_REFERENCE_KELVIN = 293.15
_COLDEST = -15.0
"""K below the reference, where the hyperbola of the viscosity ends before its pole."""
_SERIES = 1e-3
"""Argument below which the Langevin function is its own tangent, whose closed form would cancel."""
_RISE = 200.0
"""1/s, at which a decaying magnetisation follows a rising current: within a row and a half."""


@compiled
def viscous_factor(t: float, p: RigParameters) -> float:
    """Return viscosity at `t` degC over that at 20: Arrhenius `exp(B (1/T - 1/T20))` or `1 / (1 + b (t - 20))`."""
    if p.fade_law == 1.0:
        return math.exp(p.fade_viscous * (1000.0 / (t + _ZERO) - 1000.0 / _REFERENCE_KELVIN))
    return 1.0 / (1.0 + p.fade_viscous * max(t - _REFERENCE, _COLDEST))


@compiled
def yield_factor(t: float, p: RigParameters) -> float:
    """Return yield stress at `t` degC over that at 20: exponential or a power of the absolute temperature."""
    if p.fade_law == 1.0:
        return math.exp(-p.fade_yield * (t - _REFERENCE))
    return float(((t + _ZERO) / _REFERENCE_KELVIN) ** (-p.fade_yield))


@compiled
def write_heat_rates(y: Array, rates: Array, power: float, p: RigParameters) -> None:
    """Write the rates of fluid, housing and thermometer, K/s: the fluid is heated by |power| and cools to the air."""
    flow = p.fluid_to_housing * (y[state.T_FLUID] - y[state.T_HOUSING])
    rates[state.T_FLUID] = (abs(power) - flow) / p.fluid_heat
    rates[state.T_HOUSING] = (flow - p.housing_to_air * (y[state.T_HOUSING] - p.t_ambient)) / p.housing_heat
    rates[state.T_THERMOMETER] = (y[state.T_HOUSING] - y[state.T_THERMOMETER]) / p.thermometer_time


@compiled
def yield_current(y: Array, memory: Array, p: RigParameters) -> float:
    """Return the current that the yield force feels, A.

    Remanence: mean of relays with several widths (Preisach), or a magnetisation that rises at once and decays slowly.
    Saturation: Froehlich `i / (1 + b i)` or Langevin `I (coth(3 i / I) - I / (3 i))`.
    """
    i: float = y[state.CURRENT]
    felt = i
    if p.relay_share != 0.0:
        felt += p.relay_share * (memory[state.RELAYS_MEAN] - i)
    if p.remanence_gain != 0.0:
        felt += p.remanence_gain * (y[state.MAGNETISATION] - i)
    if p.saturation_froehlich != 0.0:
        felt = felt / (1.0 + p.saturation_froehlich * max(felt, 0.0))
    if p.saturation_langevin != 0.0:
        u = 3.0 * felt * p.saturation_langevin
        if u > _SERIES:
            felt = (1.0 / math.tanh(u) - 1.0 / u) / p.saturation_langevin
    return felt


@compiled
def write_magnetisation_rate(y: Array, rates: Array, p: RigParameters) -> None:
    """Write the rate of a magnetisation that follows a rising current and decays after a falling one.

    The further the current has fallen, the faster it decays: `(0.4 + 2 |di|) / tau`, as domains need a field to turn.
    """
    if p.remanence_gain != 0.0:
        rise = y[state.CURRENT] - y[state.MAGNETISATION]
        fall_rate = rise * (0.4 - 2.0 * rise) / p.remanence_time
        rates[state.MAGNETISATION] = rise * _RISE if rise > 0.0 else fall_rate


@compiled
def update_relays(y: Array, memory: Array, relays: Array, p: RigParameters) -> None:
    """Switch the hysteresis relays (Preisach 1935) with the current, and keep their mean.

    Relay k is centred at `(k + 1/2) / N` A; widths of 0.4 to 1.6 times the mean are dealt out in steps of seven, which
    shares no divisor with N, so that width and centre are uncorrelated.
    """
    total = 0.0
    for k in range(state.RELAYS):
        half = 0.5 * p.relay_width * (0.4 + 1.2 * ((k * 7) % state.RELAYS) / state.RELAYS)
        centre = (k + 0.5) / state.RELAYS
        if y[state.CURRENT] > centre + half:
            relays[k] = 1.0
        elif y[state.CURRENT] < centre - half:
            relays[k] = 0.0
        total += relays[k]
    memory[state.RELAYS_MEAN] = total / state.RELAYS
