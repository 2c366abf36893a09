"""Effects of the coil and its supply: lag, asymmetric lag, delay, current limit."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.effects.base import effect
from seatsim.rig.coil import Coil
from seatsim.schema.fields import param


@effect(
    "coil.lag",
    source="first-order lag; eddy currents as a second, faster pole",
    forms=({"time": 0.003}, {"time": 0.003, "second": 0.5}),
)
class CoilLag(NamedTuple):
    """A coil slower than nominal: its time constant grows, `1 / rate + time`, rising and falling alike.

    A second pole, of the time constant `second time`, acts as a delay of that length.
    """

    time: Annotated[float, param("s", "added time constant", low=-0.05, high=0.2)]
    second: Annotated[float, param("-", "second time constant over the first one", low=0, high=1)] = 0.0

    def coil(self, coil: Coil) -> Coil:
        """Return the slower coil."""
        fall = _slower(coil.rate_fall, self.time) if coil.rate_fall > 0.0 else 0.0
        delay = coil.delay + max(0.0, self.second * self.time)
        return coil._replace(rate=_slower(coil.rate, self.time), rate_fall=fall, delay=delay)


@effect("coil.asymmetric_lag", source="freewheeling diode of the current driver", forms=({"time": 0.004},))
class AsymmetricLag(NamedTuple):
    """A coil whose current falls more slowly than it rises: time constant `1 / rate + time` when falling."""

    time: Annotated[float, param("s", "added time constant of a falling current", low=0, high=0.2)]

    def coil(self, coil: Coil) -> Coil:
        """Return the coil with the slower fall."""
        return coil._replace(rate_fall=_slower(coil.rate_fall if coil.rate_fall > 0.0 else coil.rate, self.time))


@effect("coil.delay", source="sampling and bus latency", forms=({"time": 0.004}, {"time": 0.013}, {"time": 0.03}))
class Delay(NamedTuple):
    """Pure transport delay from command to coil."""

    time: Annotated[float, param("s", "delay", low=0, high=0.2)]

    def coil(self, coil: Coil) -> Coil:
        """Return the coil with the delay added."""
        return coil._replace(delay=coil.delay + self.time)


@effect("coil.current_limit", source="supply in saturation", off={"limit": 1e3}, forms=({"limit": 0.8}, {"limit": 0.5}))
class CurrentLimit(NamedTuple):
    """A supply that cannot reach the commanded current."""

    limit: Annotated[float, param("A", "largest current of the supply", above=0, high=1e3)]

    def coil(self, coil: Coil) -> Coil:
        """Return the coil with the lower limit."""
        return coil._replace(max_current=min(coil.max_current, self.limit))


def _slower(rate: float, time: float) -> float:
    return 1.0 / max(1e-5, 1.0 / rate + time)
