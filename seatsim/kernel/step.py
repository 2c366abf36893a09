"""One step of the rig: classical Runge-Kutta of order 4, sub-stepped where the rig is stiff or sticks.

The derivative at the end of a step serves as the first stage of the next, and as the fifth stage of an embedded
solution of order 3; their difference `h (k4 - k5) / 6` in the velocities is the error estimate. A smooth rig takes one
sub-step a step at four evaluations; a stiff damper, a branch or an end stop takes as many as the tolerance requires.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.compilation.jit import jit, jit_apart
from seatsim.kernel.hooks import MOST_DEBT, axpy, combine, owe
from seatsim.kernel.rig import STICKING, Disturbance, Rig, RigForces, derivative
from seatsim.rig.coil import Coil, relax
from seatsim.rig.state import CUSHION_DISPLACEMENT, CUSHION_VELOCITY, VELOCITY, State
from seatsim.rig.temperature import TemperatureScaling

relaxed = jit(relax)
_SPEED_SCALE = 0.01
"""m/s added to the speeds that the tolerance is relative to, so that a rig near rest needs no sub-steps."""
_SHORTEST = 2.0**-18
"""Shortest sub-step as a fraction of the step; at 1 ms some 4 ns, in which no rig of a seat moves."""
_EVENT_TOLERANCE = 1e-10
"""m/s and N; tolerances on speed and friction with which the ends of sliding and of sticking are found."""
_MOST_TRIALS = 60
"""Most iterations in finding the end of a phase; bisection alone would be at rounding error by then."""
_SAFETY, _LEAST, _GREATEST = 0.9, 0.2, 4.0
"""Factors on a next sub-step: safety factor on the one that would meet the tolerance, and limits of the change."""
_REJECTED_LEAST = 0.1
"""Least factor on a sub-step whose error was too great: it may be shortened further than one that succeeded."""
_ERROR_EXPONENT = 0.25
"""The error of the embedded solution, of order 3, grows with the fourth power of the sub-step."""
_NEGLIGIBLE = 1e-3
"""Error in units of the tolerance below which a sub-step grows by _GREATEST, which saves computing a power."""
_DIVERGED = 1e12
"""Error in units of the tolerance at which a solution has diverged; a NaN fails the same comparison."""
_REMAINDER = 1e-12
"""Share of the remaining step that the last sub-step may fall short by, as an allowance for rounding of time."""


class StepInputs(NamedTuple):
    """What acts on the rig during one step of `length` seconds.

    Floor acceleration and forces run linearly from the `first` disturbance by `rise`. The coil relaxes from `current`
    [A] towards the command `before` for the first `split` seconds and towards `after` from then on; with a `prescribed`
    current it runs linearly to `after`. `kept` is the share of the distance to the command after half a step, of a
    rising and a falling current.
    """

    length: float
    first: Disturbance
    rise: Disturbance
    current: float
    before: float
    after: float
    split: float
    prescribed: bool
    kept: tuple[float, float]


class IntegratorState(NamedTuple):
    """State of the integration: state of the rig, its rates and forces, phase of the friction, next sub-step in s.

    `slip` is 0 without set-valued friction, -1 or 1 where the suspension slides, STICKING where it is stuck; `debt` the
    sub-steps owed (`seatsim.kernel.hooks.owe`).
    """

    state: State
    rates: State
    forces: RigForces
    slip: float
    substep: float
    debt: float


@jit
def current_at(coil: Coil, inputs: StepInputs, time: float) -> float:
    """Return the coil current in A `time` seconds into the step, 0 to `inputs.length`; exact but for rounding."""
    if inputs.prescribed:
        return inputs.current + (inputs.after - inputs.current) * time / inputs.length
    if inputs.split <= 0.0:
        return relaxed(coil, inputs.current, inputs.after, time)
    if time <= inputs.split:
        return relaxed(coil, inputs.current, inputs.before, time)
    return relaxed(coil, relaxed(coil, inputs.current, inputs.before, inputs.split), inputs.after, time - inputs.split)


@jit
def _currents(coil: Coil, inputs: StepInputs, time: float, h: float) -> tuple[float, float]:
    """Return the coil current in the middle and at the end of a sub-step of `h` from `time`."""
    # A whole step with one command is by far the most common case: `kept` saves it two exponentials.
    if h < inputs.length or inputs.split > 0.0 or inputs.prescribed:
        return current_at(coil, inputs, time + 0.5 * h), current_at(coil, inputs, time + h)
    kept = inputs.kept[0] if inputs.after > inputs.current else inputs.kept[1]
    middle = inputs.after + (inputs.current - inputs.after) * kept
    return middle, inputs.after + (middle - inputs.after) * kept


@jit
def disturbance_at(inputs: StepInputs, time: float) -> Disturbance:
    """Return what excites the seat `time` seconds into the step."""
    first, rise, part = inputs.first, inputs.rise, time / inputs.length
    return Disturbance(
        first.floor + rise.floor * part,
        first.frame_force + rise.frame_force * part,
        first.driver_force + rise.driver_force * part,
    )


@jit
def start(
    rig: Rig, state: State, disturbance: Disturbance, current: float, scaling: TemperatureScaling, substep: float
) -> IntegratorState:
    """Return the initial state of the integration, for a rig in `state` that slides or is at rest.

    `disturbance` and `current` [A] act at that instant; `substep` [s] is the first sub-step that is tried.
    """
    rates, forces = derivative(rig, state, disturbance, current, scaling, 0.0)
    return IntegratorState(state, rates, forces, _phase(state, rates, forces), substep, 0.0)


@jit
def _phase(state: State, rates: State, forces: RigForces) -> float:
    """Return STICKING or the direction in which the suspension slides, 0 where there is no friction."""
    if forces.friction_limit <= 0.0:
        return 0.0
    if state[VELOCITY] == 0.0 and rates[VELOCITY] == 0.0:
        return STICKING
    return math.copysign(1.0, rates[VELOCITY] if state[VELOCITY] == 0.0 else state[VELOCITY])


@jit
def _margin(slip: float, state: State, forces: RigForces) -> float:
    """Return the margin of a phase to its end, negative beyond it: unused friction in N, or speed of sliding in m/s."""
    if slip == STICKING:
        return forces.friction_limit - abs(forces.friction)
    return slip * state[VELOCITY]


@jit
def take_substep(
    rig: Rig, coil: Coil, inputs: StepInputs, scaling: TemperatureScaling, now: IntegratorState, time: float, h: float
) -> tuple[State, State, RigForces, State, float]:
    """Return state, rates, forces after a sub-step of `h` from `time`, the fourth stage, and the current at the end.

    The phase of the friction is constant over the sub-step; the caller checks whether it ended within.
    """
    middle, end = disturbance_at(inputs, time + 0.5 * h), disturbance_at(inputs, time + h)
    i_middle, i_end = _currents(coil, inputs, time, h)
    k1, slip = now.rates, now.slip
    k2, _ = derivative(rig, axpy(now.state, 0.5 * h, k1), middle, i_middle, scaling, slip)
    k3, _ = derivative(rig, axpy(now.state, 0.5 * h, k2), middle, i_middle, scaling, slip)
    k4, _ = derivative(rig, axpy(now.state, h, k3), end, i_end, scaling, slip)
    state = combine(now.state, h, k1, k2, k3, k4)
    rates, forces = derivative(rig, state, end, i_end, scaling, slip)
    return state, rates, forces, k4, i_end


@jit
def advance(
    rig: Rig, coil: Coil, inputs: StepInputs, scaling: TemperatureScaling, now: IntegratorState, tolerance: float
) -> tuple[IntegratorState, float, bool]:
    """Return the state of the integration after one step, the current then in A, and whether the step succeeded.

    A step fails where the error stays beyond `_DIVERGED` even in the shortest sub-step, or is NaN; the last valid state
    is then returned. So does one by which the run takes more work than `seatsim.kernel.hooks` grants. `tolerance`
    is the error in the velocities that a sub-step may add, relative to their size plus `_SPEED_SCALE`; above about 0.1
    it has no effect.
    """
    h = now.substep
    # The common case, a rig without set-valued friction that needs one sub-step, has a short path of its own.
    if h == inputs.length and now.forces.friction_limit <= 0.0:
        state, rates, forces, k4, i_end = take_substep(rig, coil, inputs, scaling, now, 0.0, h)
        if forces.friction_limit <= 0.0 and estimate_error(state, rates, k4, h, tolerance) <= 1.0:
            return IntegratorState(state, rates, forces, 0.0, h, owe(now.debt, 1.0)), i_end, True
    return _advance_divided(rig, coil, inputs, scaling, now, tolerance)


@jit
def estimate_error(state: State, rates: State, k4: State, h: float, tolerance: float) -> float:
    """Return the estimated error in the velocities over a sub-step of `h`, in units of the tolerance.

    Only the velocities count: displacements are their integrals, and a damper's state shows in them by its force.
    """
    scale = tolerance * (_SPEED_SCALE + abs(state[VELOCITY]) + abs(state[CUSHION_VELOCITY]))
    return h / 6.0 * (abs(k4[VELOCITY] - rates[VELOCITY]) + abs(k4[CUSHION_VELOCITY] - rates[CUSHION_VELOCITY])) / scale


@jit_apart
def _advance_divided(
    rig: Rig, coil: Coil, inputs: StepInputs, scaling: TemperatureScaling, now: IntegratorState, tolerance: float
) -> tuple[IntegratorState, float, bool]:
    """Advance by one step in as many sub-steps as it needs, with the set-valued friction."""
    time, current, h = 0.0, inputs.current, now.substep
    remaining, parts = inputs.length, 0.0
    while parts <= MOST_DEBT:
        parts += 1.0
        last = h >= remaining * (1.0 - _REMAINDER)
        if last:
            h = remaining
        state, rates, forces, k4, i_end = take_substep(rig, coil, inputs, scaling, now, time, h)
        error = estimate_error(state, rates, k4, h, tolerance)
        # Written so that a NaN error is rejected.
        if not error <= 1.0 and h > _SHORTEST * inputs.length:
            h *= max(_REJECTED_LEAST, _SAFETY / error**_ERROR_EXPONENT) if error < _DIVERGED else _REJECTED_LEAST
            continue
        if not error < _DIVERGED:
            return now, current, False
        # The end of a phase shortens this sub-step, while the next one follows from the length that was tried.
        tried, slip = h, now.slip
        if _margin(slip, state, forces) < 0.0:
            h, state, forces, i_end = _end_of_phase(rig, coil, inputs, scaling, now, time, h, state, forces)
            last = last and h == tried
            # The event is found to _EVENT_TOLERANCE only; the velocity is then set to zero exactly, which marks rest.
            state = state[:VELOCITY] + (0.0,) + state[CUSHION_DISPLACEMENT:]
            # A suspension that breaks loose slides in the force's direction; one that came to rest may stick or turn.
            slip = math.copysign(1.0, forces.friction) if slip == STICKING else 0.0
            rates, forces = derivative(rig, state, disturbance_at(inputs, time + h), i_end, scaling, slip)
        if slip == 0.0 or forces.friction_limit <= 0.0:
            slip = _phase(state, rates, forces)
        now = IntegratorState(state, rates, forces, slip, h, now.debt)
        time += h
        current = i_end
        remaining = 0.0 if last else inputs.length - time
        h = _longer(tried, error, inputs.length)
        if remaining <= 0.0:
            debt = owe(now.debt, parts)
            return IntegratorState(now.state, now.rates, now.forces, now.slip, h, debt), current, debt <= MOST_DEBT
    return now, current, False


@jit
def _end_of_phase(
    rig: Rig,
    coil: Coil,
    inputs: StepInputs,
    scaling: TemperatureScaling,
    now: IntegratorState,
    time: float,
    h: float,
    state: State,
    forces: RigForces,
) -> tuple[float, State, RigForces, float]:
    """Return the time until sliding or sticking ends, the state, forces and current then, by the Illinois method.

    The end lies within `h`, after which `state` and `forces` were found. A bracket that has no margin at its beginning
    is bisected, since false position would stay there.
    """
    low, high, side = 0.0, h, 0
    m_low, m_high = _margin(now.slip, now.state, now.forces), _margin(now.slip, state, forces)
    i_end = inputs.current
    for _ in range(_MOST_TRIALS):
        h = (low * m_high - high * m_low) / (m_high - m_low) if m_low > 0.0 else 0.5 * (low + high)
        state, _, forces, _, i_end = take_substep(rig, coil, inputs, scaling, now, time, h)
        margin = _margin(now.slip, state, forces)
        if abs(margin) <= _EVENT_TOLERANCE or high - low <= _SHORTEST * inputs.length:
            break
        if margin > 0.0:
            m_high *= 0.5 if side > 0 else 1.0
            low, m_low, side = h, margin, 1
        else:
            m_low *= 0.5 if side < 0 else 1.0
            high, m_high, side = h, margin, -1
    return h, state, forces, i_end


@jit
def _longer(h: float, error: float, length: float) -> float:
    """Return the next sub-step after one of `h` with the given error in units of the tolerance."""
    if h >= length:
        return length
    factor = _GREATEST if error < _NEGLIGIBLE else min(_GREATEST, max(_LEAST, _SAFETY / error**_ERROR_EXPONENT))
    return min(max(h * factor, _SHORTEST * length), length)
