"""An excitation in one file: a record of keys, and the motion of the floor."""

from typing import Annotated, NamedTuple

import numpy as np

from seatsim.excitations.base import Floor, excitation
from seatsim.schema.fields import param


# The name is what a scenario says under `kind`.
@excitation("my_excitation", source="state your source")
class MyExcitation(NamedTuple):
    """A tone that swells: `z0 = A (1 - exp(-t / rise)) sin(2 pi f t)`, its derivatives by differences."""

    duration: Annotated[float, param("s", "length of the run", above=0, high=7200)] = 20.0
    amplitude: Annotated[float, param("m", "amplitude A", low=0, high=0.1)] = 0.01
    frequency: Annotated[float, param("Hz", "frequency f", above=0, high=50)] = 2.0
    rise: Annotated[float, param("s", "time constant of the swell", above=0, high=100)] = 2.0

    def floor(self, step: float, seed: int) -> Floor:
        """Return the floor's motion every `step` seconds, upward positive; random draws derive from `seed`."""
        time = step * np.arange(round(self.duration / step) + 1)
        swell = 1.0 - np.exp(-time / self.rise)
        position = self.amplitude * swell * np.sin(2.0 * np.pi * self.frequency * time)
        velocity = np.gradient(position, step)
        return Floor(step, np.gradient(velocity, step), velocity, position)
