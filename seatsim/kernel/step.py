"""One step of the rig: classical Runge-Kutta of order 4, sub-stepped where the rig is stiff or sticks.

The derivative at the end of a step serves as the first stage of the next, and as the fifth stage of an embedded
solution of order 3; their difference `h (k4 - k5) / 6` in the velocities is the error estimate. A smooth rig takes one
sub-step a step at four evaluations; a stiff damper, a branch or an end stop takes as many as the tolerance needs.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from seatsim.compilation.jit import jit, jit_apart
from seatsim.kernel.generic import Tuple, axpy, combine
from seatsim.kernel.rig import HELD, Flow, Rig, Shake, derivative
from seatsim.rig.coil import Coil, relax
from seatsim.rig.temperature import TemperatureScaling

relaxed = jit(relax)
FLOOR_OF_ERROR_SCALE = 0.01
"""m/s added to the speed that the tolerance is relative to."""
SMALLEST = 2.0**-18
"""Shortest sub-step as a fraction of the step."""
SHARP = 1e-10
"""Speed in m/s, and excess of the friction in N, to which the ends of sliding and of rest are resolved."""
MOST = 1_000_000
"""Most sub-steps of a step: a run that needs more has failed."""
TRIES = 60
"""Most sub-steps on the way to such an end."""


class Drive(NamedTuple):
    """What acts on the rig during one step of `length` seconds.

    Floor acceleration runs linearly from `floor` by `floor_rise`, forces on
    frame and driver from `push` and `lift` by their rises. The coil relaxes from `current` towards `before` for
    the first `split` seconds and towards `after` from then on; with a `prescribed` current it runs linearly to `after`.
    `kept` is what half a step leaves of the distance to the command, of a rising and of a falling current.
    """

    length: float
    floor: float
    floor_rise: float
    current: float
    before: float
    after: float
    split: float
    prescribed: bool
    kept: tuple[float, float]
    push: float = 0.0
    push_rise: float = 0.0
    lift: float = 0.0
    lift_rise: float = 0.0


class Progress(NamedTuple):
    """Where the integration stands: state, its rates and flow, sliding direction, last sub-step in s."""

    state: Tuple
    rates: Tuple
    flow: Flow
    slip: float
    substep: float


@jit
def current_at(coil: Coil, drive: Drive, time: float) -> float:
    """Return the coil current `time` seconds into the step."""
    if drive.prescribed:
        return drive.current + (drive.after - drive.current) * time / drive.length
    if drive.split <= 0.0:
        return relaxed(coil, drive.current, drive.after, time)
    if time <= drive.split:
        return relaxed(coil, drive.current, drive.before, time)
    return relaxed(coil, relaxed(coil, drive.current, drive.before, drive.split), drive.after, time - drive.split)


@jit
def _currents(coil: Coil, drive: Drive, time: float, h: float) -> tuple[float, float]:
    """Return the coil current in the middle and at the end of a sub-step of `h` from `time`."""
    if h < drive.length or drive.split > 0.0 or drive.prescribed:
        return current_at(coil, drive, time + 0.5 * h), current_at(coil, drive, time + h)
    kept = drive.kept[0] if drive.after > drive.current else drive.kept[1]
    middle = drive.after + (drive.current - drive.after) * kept
    return middle, drive.after + (middle - drive.after) * kept


@jit
def shake_at(drive: Drive, time: float) -> Shake:
    """Return what shakes the seat `time` seconds into the step."""
    part = time / drive.length
    return Shake(
        drive.floor + drive.floor_rise * part, drive.push + drive.push_rise * part, drive.lift + drive.lift_rise * part
    )


@jit
def start(
    rig: Rig, state: Tuple, shake: Shake, current: float, scaling: TemperatureScaling, substep: float
) -> Progress:
    """Return the progress of a rig in `state`, sliding or at rest."""
    rates, flow = derivative(rig, state, shake, current, scaling, 0.0)
    return Progress(state, rates, flow, _phase(state, rates, flow), substep)


@jit
def _phase(state: Tuple, rates: Tuple, flow: Flow) -> float:
    """Return whether the suspension is held or in which direction it slides, 0 where there is no friction."""
    if flow.friction_limit <= 0.0:
        return 0.0
    if state[1] == 0.0 and rates[1] == 0.0:
        return HELD
    return math.copysign(1.0, rates[1] if state[1] == 0.0 else state[1])


@jit
def _margin(slip: float, state: Tuple, flow: Flow) -> float:
    """Return how far the phase is from its end, below zero beyond it: friction left in N, or speed of sliding."""
    if slip == HELD:
        return flow.friction_limit - abs(flow.friction)
    return slip * state[1]


@jit
def _try(
    rig: Rig, coil: Coil, drive: Drive, scaling: TemperatureScaling, now: Progress, time: float, h: float
) -> tuple[Tuple, Tuple, Flow, Tuple, float]:
    """Return state, rates, flow after a sub-step of `h` from `time`, the fourth stage, and the current at the end."""
    middle, end = shake_at(drive, time + 0.5 * h), shake_at(drive, time + h)
    i_middle, i_end = _currents(coil, drive, time, h)
    k1, slip = now.rates, now.slip
    k2, _ = derivative(rig, axpy(now.state, 0.5 * h, k1), middle, i_middle, scaling, slip)
    k3, _ = derivative(rig, axpy(now.state, 0.5 * h, k2), middle, i_middle, scaling, slip)
    k4, _ = derivative(rig, axpy(now.state, h, k3), end, i_end, scaling, slip)
    state = combine(now.state, h, k1, k2, k3, k4)
    rates, flow = derivative(rig, state, end, i_end, scaling, slip)
    return state, rates, flow, k4, i_end


@jit
def advance(
    rig: Rig, coil: Coil, drive: Drive, scaling: TemperatureScaling, now: Progress, tolerance: float
) -> tuple[Progress, float, bool]:
    """Return the progress after one step, the current then, and whether the step succeeded."""
    h = now.substep
    if h == drive.length and now.flow.friction_limit <= 0.0:
        state, rates, flow, k4, i_end = _try(rig, coil, drive, scaling, now, 0.0, h)
        if flow.friction_limit <= 0.0 and _error(state, rates, k4, h, tolerance) <= 1.0:
            return Progress(state, rates, flow, 0.0, h), i_end, True
    return _divided(rig, coil, drive, scaling, now, tolerance)


@jit
def _error(state: Tuple, rates: Tuple, k4: Tuple, h: float, tolerance: float) -> float:
    """Return the estimated error in the velocities over a sub-step of `h`, in units of the tolerance."""
    scale = tolerance * (FLOOR_OF_ERROR_SCALE + abs(state[1]) + abs(state[3]))
    return h / 6.0 * (abs(k4[1] - rates[1]) + abs(k4[3] - rates[3])) / scale


@jit_apart
def _divided(
    rig: Rig, coil: Coil, drive: Drive, scaling: TemperatureScaling, now: Progress, tolerance: float
) -> tuple[Progress, float, bool]:
    """Advance by one step in as many sub-steps as it needs, with the set-valued friction."""
    time, current, h = 0.0, drive.current, now.substep
    remaining = drive.length
    for _ in range(MOST):
        last = h >= remaining * (1.0 - 1e-12)
        if last:
            h = remaining
        state, rates, flow, k4, i_end = _try(rig, coil, drive, scaling, now, time, h)
        error = _error(state, rates, k4, h, tolerance)
        if not error <= 1.0 and h > SMALLEST * drive.length:
            h *= max(0.1, 0.9 / error**0.25) if error < 1e12 else 0.1
            continue
        if not error < 1e12:
            return now, current, False
        tried, slip = h, now.slip
        if _margin(slip, state, flow) < 0.0:
            h, state, flow, i_end = _end_of_phase(rig, coil, drive, scaling, now, time, h, state, flow)
            last = last and h == tried
            state = state[:1] + (0.0,) + state[2:]
            slip = math.copysign(1.0, flow.friction) if slip == HELD else 0.0
            rates, flow = derivative(rig, state, shake_at(drive, time + h), i_end, scaling, slip)
        if slip == 0.0 or flow.friction_limit <= 0.0:
            slip = _phase(state, rates, flow)
        now = Progress(state, rates, flow, slip, h)
        time += h
        current = i_end
        remaining = 0.0 if last else drive.length - time
        h = _longer(tried, error, drive.length)
        if remaining <= 0.0:
            return Progress(now.state, now.rates, now.flow, now.slip, h), current, True
    return now, current, False


@jit
def _end_of_phase(
    rig: Rig,
    coil: Coil,
    drive: Drive,
    scaling: TemperatureScaling,
    now: Progress,
    time: float,
    h: float,
    state: Tuple,
    flow: Flow,
) -> tuple[float, Tuple, Flow, float]:
    """Return the time until sliding or rest ends, the state, flow and current then, by the Illinois method.

    The end lies within `h`, after which `state` and `flow` were found.
    """
    low, high, side = 0.0, h, 0
    m_low, m_high = _margin(now.slip, now.state, now.flow), _margin(now.slip, state, flow)
    i_end = drive.current
    for _ in range(TRIES):
        h = (low * m_high - high * m_low) / (m_high - m_low) if m_low > 0.0 else 0.5 * (low + high)
        state, _, flow, _, i_end = _try(rig, coil, drive, scaling, now, time, h)
        margin = _margin(now.slip, state, flow)
        if abs(margin) <= SHARP or high - low <= SMALLEST * drive.length:
            break
        if margin > 0.0:
            m_high *= 0.5 if side > 0 else 1.0
            low, m_low, side = h, margin, 1
        else:
            m_low *= 0.5 if side < 0 else 1.0
            high, m_high, side = h, margin, -1
    return h, state, flow, i_end


@jit
def _longer(h: float, error: float, length: float) -> float:
    """Return the next sub-step after one of `h` with the given error in units of the tolerance."""
    if h >= length:
        return length
    factor = 4.0 if error < 1e-3 else min(4.0, max(0.2, 0.9 / error**0.25))
    return min(max(h * factor, SMALLEST * length), length)
