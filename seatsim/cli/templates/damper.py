"""A damper model in one file: a record of parameters, and the force that it gives."""

from typing import Annotated, NamedTuple

from seatsim.dampers import State, TemperatureScaling, damper, param


# The name is what a scenario says under `model`. `current_order=1` promises that the force is linear in the current, so
# that the inverse has a closed form; 0 promises nothing. Speed, current and temperatures are the range of your data.
@damper("my_damper", source="state your source", current_order=1, max_speed=0.3, max_current=1.0)
class MyDamper(NamedTuple):
    """F = (a + b i) v |v|^(p - 1)."""

    # Unit, meaning and bounds; `seatsim identify` fits within the bounds, from the values that stand here.
    a: Annotated[float, param("N (s/m)^p", "damping at zero current", low=0, high=1e4)] = 200.0
    b: Annotated[float, param("N (s/m)^p / A", "its rise with current", low=0, high=1e5)] = 900.0
    p: Annotated[float, param("-", "exponent", low=0.3, high=2)] = 0.5

    # Compiled: plain arithmetic and `math` only. A model with a state adds `rates(self, x, v, i, scaling, z)`, and says
    # what it is at rest in the decorator: `initial=(0.0,)`.
    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the force in N, positive where it opposes extension; x in m, v in m/s, i in A."""
        size: float = abs(v) ** self.p
        return (self.a + self.b * i) * scaling.viscous * (size if v > 0 else -size)
