"""An effect in one file: a small physical change of the rig, which is off where its parameters are zero."""

from typing import Annotated, NamedTuple

from seatsim.effects import Plant, State, effect, param


# The part before the dot is the block that the effect lives in: damper, coil, suspension, cushion, driver, floor or
# sensor. `forms` are the parameters that `seatsim diagnose` frees, with their start values.
@effect("suspension.my_effect", source="state your source", forms=({"drag": 200.0},))
class MyEffect(NamedTuple):
    """Drag that grows with the square of speed, beside the spring: `f = drag v |v|`."""

    drag: Annotated[float, param("N s^2/m^2", "drag", low=0, high=1e5)]

    # An effect acts through the methods that it has; `seatsim/effects/base.py` lists them all.
    def suspension_force(self, plant: Plant, x: float, v: float, z: State) -> float:
        """Return the force in N beside the suspension's spring, positive where it opposes extension."""
        return self.drag * v * abs(v)
