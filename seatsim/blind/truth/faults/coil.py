"""Fault scenarios of the coil's effects; equations in `physics.coil`."""

from __future__ import annotations

from numpy.random import Generator

from seatsim.blind.truth.faults.scenario import (
    Changes,
    Context,
    FaultScenario,
    Shape,
    draw_nothing,
    set_parameters,
)

COIL_RATE = 130.0
"""1/s, of the nominal coil; the second pole is faster by 1 / ratio."""


def _two_pole(severity: float, shape: Shape, _: Context) -> Changes:
    # eddy currents as a second pole; the first one is slowed too, so that the whole step response is later
    if severity <= 0.0:
        return Changes()
    return set_parameters(second_rate=COIL_RATE / (shape["ratio"] * severity), rate_factor=1.0 / (1.0 + 0.6 * severity))


def _branches(severity: float, shape: Shape, _: Context) -> Changes:
    # a fast branch and a slow one; where its share cannot grow any more, the slow branch is slowed instead
    weight = min(0.3 * severity, 0.95)
    more = max(0.3 * severity - 0.95, 0.0)
    return set_parameters(
        slow_share=weight, slow_rate=shape["slow"] / (1.0 + more), rate_factor=1.0 / (1.0 + 0.25 * severity)
    )


def _lag_shape(rng: Generator, _: Context) -> Shape:
    return {"ratio": rng.uniform(0.1, 0.4), "slow": rng.uniform(25.0, 50.0)}


def _fall(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(fall_law=1.0, fall_slow=0.6 * severity)


def _fall_low(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(fall_law=2.0, fall_slow=0.6 * severity)


def _delay(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(delay=0.004 * severity)


def _jitter(severity: float, shape: Shape, _: Context) -> Changes:
    return set_parameters(delay=0.004 * severity, delay_jitter=shape["jitter"])


def _jitter_shape(rng: Generator, _: Context) -> Shape:
    return {"jitter": rng.uniform(0.1, 0.35)}


def _limit_shape(rng: Generator, _: Context) -> Shape:
    return {"power": rng.uniform(7.0, 20.0), "sag": rng.uniform(0.1, 0.35)}


def _ceiling(severity: float, shape: Shape, _: Context) -> Changes:
    # well above the supply at severity zero, and so sharp there that no current below it is changed
    return (
        set_parameters(limit=1.25 / (1.0 + 0.5 * severity), limit_power=shape["power"] + 4.0 / severity)
        if severity > 0.0
        else Changes()
    )


def _sagging(severity: float, shape: Shape, _: Context) -> Changes:
    if severity <= 0.0:
        return Changes()
    # the sag lowers the limit by itself, so this starts a little higher than the limit above
    limit = 1.25 / (1.0 + 0.45 * severity)
    return set_parameters(
        limit=limit, limit_power=shape["power"] + 4.0 / severity, limit_sag=shape["sag"] * min(severity, 1.5)
    )


SCENARIOS = (
    FaultScenario("lag-eddy", "coil.lag", "coil", _lag_shape, _two_pole, (0.02, 12.0)),
    FaultScenario("lag-branches", "coil.lag", "coil", _lag_shape, _branches, (0.02, 8.0)),
    FaultScenario("fall-diode", "coil.asymmetric_lag", "coil", draw_nothing, _fall, (0.02, 15.0)),
    FaultScenario("fall-low", "coil.asymmetric_lag", "coil", draw_nothing, _fall_low, (0.02, 15.0)),
    FaultScenario("delay-pure", "coil.delay", "coil", draw_nothing, _delay, (0.05, 8.0)),
    FaultScenario("delay-jitter", "coil.delay", "coil", _jitter_shape, _jitter, (0.05, 8.0)),
    FaultScenario("limit-soft", "coil.current_limit", "coil", _limit_shape, _ceiling, (0.02, 8.0)),
    FaultScenario("limit-sag", "coil.current_limit", "coil", _limit_shape, _sagging, (0.02, 6.0)),
)
