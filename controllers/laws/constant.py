"""Laws that ask for a current without looking at the motion: a constant one, and a recorded one."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from seatsim.rig.control import Measurement, State, law
from seatsim.schema.fields import param


@law("constant")
class Constant(NamedTuple):
    """Passive damper: `i_cmd = current`."""

    current: Annotated[float, param("A", "commanded current", low=0, high=100)]

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the commanded current in A."""
        return self.current


@law("replay", replays=True)
class Replay(NamedTuple):
    """The recorded command, held from its row until the next; `current` where a recording has no command."""

    current: Annotated[float, param("A", "commanded current where none is recorded", low=0, high=100)] = 0.0

    def wanted_current(self, y: Measurement, state: State) -> float:
        """Return the recorded command in A, or the constant."""
        return self.current if y.replayed != y.replayed else y.replayed
