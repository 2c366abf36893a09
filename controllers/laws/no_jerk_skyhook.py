"""Skyhook whose force goes to zero with the suspension's velocity, so that it does not jump where the clip lets go."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.schema.fields import param

SOURCE = (
    "Ahmadian, Song and Southward 2004, J. Vib. Acoust. 126:580, and US patent 6,115,658, which leave the shape of the"
    " factor open; |v| is chosen here"
)


@law("no_jerk_skyhook", source=SOURCE)
class NoJerkSkyhook(NamedTuple):
    """No-jerk skyhook: wanted force `Fd = gain zs' |v|`, continuous where v changes its sign."""

    gain: Annotated[float, param("N s^2/m^2", "force over absolute times relative velocity", low=0, high=1e8)] = 20000.0

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return self.gain * y.frame_velocity * abs(y.velocity)
