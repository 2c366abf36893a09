"""Keys that several excitations share, stated once for YAML files, documentation and error messages."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field
from pydantic.fields import FieldInfo

from seatsim.schema.fields import param


def choice(meaning: str, unit: str = "") -> FieldInfo:
    """Describe a key that has no numeric bounds of its own: a choice, a list or a nested record."""
    described: FieldInfo = Field(description=meaning, json_schema_extra={"unit": unit})
    return described


DURATION = param("s", "length of the run", above=0, high=7200)
Duration = Annotated[float, DURATION]
SPEED = param("m/s", "constant vehicle speed", low=1, high=60, usual=(1, 45))
Speed = Annotated[float, SPEED]
Through = Annotated[
    Literal["vehicle", "direct"],
    choice("path from road to floor: 'vehicle' (tyre, body and cab mounts) or 'direct' (the floor is the road)"),
]
Quantity = Annotated[
    Literal["displacement", "acceleration"],
    choice("what the amplitude is of: displacement in m or acceleration in m/s^2"),
]
