"""A damper that is a functional mock-up unit: what a scenario states of it, and its force as the time loop sees it."""

from typing import NamedTuple

from seatsim.dampers.base import DamperSpecification
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureScaling
from seatsim.schema.errors import InputError
from seatsim.schema.registry import register

PREFIX = "fmu:"
"""What the name of a damper's model begins with where a file follows."""


class FmuDamper(NamedTuple):
    """A unit as a damper: its file, the quantity that each of its inputs takes, its force, values of its parameters."""

    file: str
    inputs: tuple[tuple[str, str], ...]
    output: str
    parameters: tuple[tuple[str, float], ...] = ()


def require_model(damper: object) -> None:
    """Refuse a damper that is a unit.

    Raises:
        InputError: it is one, which no compiled code can call.
    """
    if isinstance(damper, FmuDamper):
        raise InputError(
            f"the damper is the unit {damper.file}, which is stepped outside the compiled loop: 'run', 'compare',"
            " 'sweep', 'seat-test' and 'gap' of a seat simulate it; for anything else fit a model to its bench tables"
            " with 'seatsim identify'"
        )


class CoupledForce(NamedTuple):
    """The force of a unit as the time loop sees it: one value in N over a step, whatever the motion within."""

    newton: float = 0.0

    def force(self, x: float, v: float, i: float, scaling: TemperatureScaling, z: State) -> float:
        """Return the force in N."""
        return self.newton


_SPECIFICATION = DamperSpecification("the supplier's unit", complete=True, confidence="derived")
# Not among the dampers: what fits, compares or prints each of those can do none of it with a unit.
for _cls in (FmuDamper, CoupledForce):
    register("coupled damper", _cls.__name__, _SPECIFICATION)(_cls)
