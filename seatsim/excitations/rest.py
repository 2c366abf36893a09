"""A floor at rest, for release tests."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.excitations.base import Floor, excitation
from seatsim.excitations.keys import Duration
from seatsim.excitations.motion import samples


@excitation("rest")
class Rest(NamedTuple):
    """A floor that does not move; the seat is released from the position in `start`."""

    duration: Duration

    def floor(self, step: float, seed: int) -> Floor:
        """Return the floor at rest."""
        still = np.zeros(samples(self.duration, step))
        return Floor(step, still, still, still)
