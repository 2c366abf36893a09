"""Skyhook laws: the damper acts as if it stood between the seat frame and the sky, where it can."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.schema.fields import param

SOURCE = "Karnopp, Crosby and Harwood 1974, J. Eng. Industry 96:619"


@law("on_off_skyhook", source=SOURCE)
class OnOffSkyhook(NamedTuple):
    """On-off skyhook: `i_cmd = on` where `zs' (zs' - z0') > 0`, else `off`.

    zs' is the absolute velocity of the seat frame. The command switches at the controller's samples only.
    """

    on: Annotated[float, param("A", "current that damps", low=0, high=100)] = 1.0
    off: Annotated[float, param("A", "current otherwise", low=0, high=100)] = 0.0

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the commanded current in A."""
        return self.on if y.frame_velocity * y.velocity > 0.0 else self.off


@law("skyhook", source=SOURCE)
class Skyhook(NamedTuple):
    """Continuous skyhook: wanted force `Fd = damping zs'`, of which the inverse delivers what dissipates."""

    damping: Annotated[float, param("N s/m", "skyhook damping", low=0, high=1e6)] = 2000.0

    def wanted_force(self, y: Measurement, state: State) -> float:
        """Return the wanted damper force in N."""
        return self.damping * y.frame_velocity
