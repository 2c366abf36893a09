"""A control law in one file: a record of settings, and the current that it wants."""

from typing import Annotated, NamedTuple

from seatsim.laws import Measurement, law, param


# The name is what a scenario says under `law`.
@law("my_controller", source="state your source")
class MyController(NamedTuple):
    """i_cmd = on where |zs' - z0'| > speed, else 0."""

    on: Annotated[float, param("A", "current that damps", low=0, high=2)] = 1.0
    speed: Annotated[float, param("m/s", "speed above which it flows", low=0, high=1)] = 0.1

    # Compiled: plain arithmetic and `math` only. A law that wants a force has `wanted_force` in its place, and the
    # scenario's inverse turns it into a current; one with a memory states `initial=(...)` and has `update`.
    def wanted_current(self, y: Measurement, state: tuple[float, ...]) -> float:
        """Return the commanded current in A."""
        return self.on if abs(y.velocity) > self.speed else 0.0
