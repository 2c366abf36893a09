"""The coil and its driver: from a commanded to a flowing current."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.schema.fields import param


class Coil(NamedTuple):
    """First-order current dynamics, `di/dt = r (u(t - delay) - i)`, with r = `rate` rising and `rate_fall` falling.

    The command u is clipped to `0 <= u <= max_current` and held between the controller's samples. Sources: Braz-Cesar
    and Barros 2012 (first-order lag, 130 1/s as a single compromise; 17 ms to 95 % on and 43 ms to 5 % off for the
    RD-1005-3, from which 176 and 70 1/s are derived); coil resistance 5 ohm there.
    """

    rate: Annotated[float, param("1/s", "rate of the current when it rises", above=0, high=1e5, usual=(1, 1e4))] = 130.0
    max_current: Annotated[float, param("A", "largest current of the driver", above=0, high=100, usual=(0.05, 20))] = (
        1.0
    )
    rate_fall: Annotated[
        float, param("1/s", "rate of the current when it falls; 0 means as `rate`", low=0, high=1e5)
    ] = 0.0
    delay: Annotated[float, param("s", "transport delay from command to coil", low=0, high=1.0, usual=(0, 0.2))] = 0.0
    resistance: Annotated[float, param("ohm", "coil resistance, for heat and electrical energy", low=0)] = 5.0


def relax(coil: Coil, current: float, command: float, time: float) -> float:
    """Return the current in A `time` seconds after `current`, under a constant command in A (exact solution).

    The command is taken as it is: its delay and its clipping to `max_current` are the caller's.
    """
    rate = coil.rate_fall if command <= current and coil.rate_fall > 0.0 else coil.rate
    return command + (current - command) * math.exp(-rate * time)
