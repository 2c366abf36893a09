"""Random roads after ISO 8608, driven at constant speed.

Displacement spectrum of a road over the wavenumber n in cycles/m, one-sided, in m^3:

    Gd(n) = Gd(n0) * (n/n0)^-2,  n0 = 0.1 cycles/m

with the geometric means Gd(n0) = 16e-6 * 4^k m^3 for the classes A (k = 0) to H (k = 7). At speed V the wave
`n` is met with frequency `f = n*V`, and `G(f) = Gd(n0) n0^2 V / f^2`.

Source: ISO 8608, classes by geometric mean. The band of 0.011 to 2.83 cycles/m is the one commonly quoted
with that standard; it was not checked against its text.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, Literal, NamedTuple

import numpy as np
from scipy.fft import irfft

from seatsim.excitations.base import Floor, excitation
from seatsim.excitations.keys import Duration, Speed, Through, choice
from seatsim.excitations.motion import check_step, clock, samples, soft_start
from seatsim.excitations.spectra import Spectrum, lines, motion_of, random_phase
from seatsim.excitations.vehicle import TRUCK, Vehicle, floor_response
from seatsim.schema.arrays import Array

RoadClass = Literal["A", "B", "C", "D", "E", "F", "G", "H"]
REFERENCE_WAVENUMBER = 0.1
LONGEST, SHORTEST = 0.011, 2.83
# Five of the longest waves, so that a short or slow run still has spectral lines down to the end of the band.
LEAST_PERIOD = 5 / LONGEST


@excitation("road", source="ISO 8608, road classes A to H by their geometric mean")
class Road(NamedTuple):
    """A random road of one ISO 8608 class at constant speed, felt at the cab floor.

    The road is a sum of waves of random phase over 0.011 to 2.83 cycles/m whose amplitudes carry the class's
    spectrum exactly, line by line; it passes `vehicle.floor_response` unless `through: direct`. The floor is
    faded in from rest over the first second. A seed gives the same road, scaled, for every class.
    """

    road_class: Annotated[RoadClass, choice("ISO 8608 class, 'A' (very good) to 'H'")]
    speed: Speed
    duration: Duration
    through: Through = "vehicle"
    vehicle: Annotated[Vehicle, choice("the vehicle between road and floor")] = TRUCK

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor.

        Raises:
            InputError: `step` holds fewer than five samples of the shortest wave.
        """
        check_step("road", step, SHORTEST * self.speed, per_period=5)
        count = samples(self.duration, step)
        # In whole seconds, so that the period, and thus the road, is the same for every step.
        size = max(count - 1, round(ceil(LEAST_PERIOD / self.speed) / step))
        spectrum = _road(self.road_class, size * step * self.speed, SHORTEST, seed)
        if self.through == "vehicle":
            spectrum = spectrum * floor_response(lines(spectrum, size * step), self.vehicle)
        return soft_start(step, motion_of(spectrum, step, size, count))


def displacement_density(wavenumber: Array, road_class: RoadClass) -> Array:
    """Return Gd(n) of a road class in m^3 at wavenumbers in cycles/m, shape of `wavenumber`."""
    roughness = 16e-6 * 4.0 ** "ABCDEFGH".index(road_class)
    return roughness * (np.asarray(wavenumber) / REFERENCE_WAVENUMBER) ** -2


def profile(road_class: RoadClass, length: float, spacing: float, seed: int) -> tuple[Array, Array]:
    """Return distance and elevation in m, each of shape (N,), of a random road at even `spacing` in m.

    Waves shorter than two and a half spacings are left out, since samples hardly tell them from longer ones.
    """
    count = round(length / spacing) + 1
    size = max(count - 1, round(LEAST_PERIOD / spacing))
    spectrum = _road(road_class, size * spacing, min(SHORTEST, 0.4 / spacing), seed)
    elevation = irfft(spectrum, n=size, norm="forward")
    return clock(count, spacing), np.resize(elevation, count)


def _road(road_class: RoadClass, period: float, shortest: float, seed: int) -> Spectrum:
    return random_phase(lambda n: displacement_density(n, road_class), LONGEST, shortest, period, seed)
