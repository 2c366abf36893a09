"""PID on the driver's absolute velocity."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, State, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param


class SampledPid(NamedTuple):
    """Compiled form of the law; its state is the leaky integral of the driver's velocity in m."""

    proportional: float
    integral: float
    derivative: float
    keep: float
    gain: float

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return (
            self.proportional * y.driver_velocity + self.integral * state[0] + self.derivative * y.driver_acceleration
        )

    def update(self, y: Measurement, state: State) -> State:
        """Return the integral at the next sample, for a velocity held until then."""
        return (self.keep * state[0] + self.gain * y.driver_velocity,)


@law("pid", initial=(0.0,), source="textbook form; the leak is added here")
class Pid(NamedTuple):
    """PID on the driver's velocity, wanted to be zero: `Fd = P zc' + I q + D zc''`, with `q' = zc' - q / leak`.

    The integral leaks, because an absolute displacement follows every hill.
    """

    proportional: Annotated[float, param("N s/m", "gain P", low=0, high=1e6)] = 1500.0
    integral: Annotated[float, param("N/m", "gain I", low=0, high=1e7)] = 1000.0
    derivative: Annotated[float, param("N s^2/m", "gain D", low=0, high=1e4)] = 5.0
    leak: Annotated[float, param("s", "time constant of the integral's leak", above=0, high=100)] = 1.0

    def sampled(self, plant: Plant, coil: Coil, sample_time: float) -> SampledPid:
        """Return the compiled form for a sample time."""
        keep = math.exp(-sample_time / self.leak)
        return SampledPid(self.proportional, self.integral, self.derivative, keep, self.leak * (1.0 - keep))
