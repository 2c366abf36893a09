"""Single bumps and rows of bumps: half-sine and haversine.

    half_sine: z(s) = height * sin(pi s/length)
    haversine: z(s) = height/2 * (1 - cos(2 pi s/length))

for 0 <= s <= length. A tyre rests on a patch, so the road it follows is the mean over the patch length p,
`z_p(s) = (Z(s + p/2) - Z(s - p/2))/p`, Z the integral of z. The kink at the foot of a half-sine, which would be
an infinite acceleration in point contact, becomes a pulse of `V^2 z'/p` over the time `p/V`: finite, with the
correct area `V z'`.
"""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np
from scipy.fft import rfft

from seatsim.excitations.base import Duration, Floor, Speed, Through, choice, excitation
from seatsim.excitations.motion import Motion, check_step, clock, floor_of, lines, motion_of, samples
from seatsim.excitations.road import TRUCK, Vehicle, floor_response, ring_down
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param


@excitation("bumps")
class Bumps(NamedTuple):
    """A row of equal bumps on a flat road at constant speed, felt at the cab floor.

    The road under the patch passes `vehicle.floor_response` unless `through: direct`. The rig starts at rest.
    """

    shape: Annotated[Literal["half_sine", "haversine"], choice("shape of a bump")]
    height: Annotated[
        float, param("m", "height of a bump; negative for a pothole", low=-0.5, high=0.5, usual=(0.002, 0.4))
    ]
    length: Annotated[float, param("m", "length of a bump along the road", above=0)]
    speed: Speed
    duration: Duration
    number: Annotated[int, param("", "number of bumps", low=1)] = 1
    spacing: Annotated[float, param("m", "from the start of a bump to the start of the next", above=0)] = 10.0
    first: Annotated[float, param("s", "time at which the tyre meets the first bump", low=0)] = 1.0
    patch: Annotated[float, param("m", "length of the tyre's contact patch", low=0.01)] = 0.25
    through: Through = "vehicle"
    vehicle: Annotated[Vehicle, choice("the vehicle between road and floor")] = TRUCK

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor; `seed` has no influence.

        Raises:
            InputError: bumps overlap, the last one is not passed within the run, or `step` holds fewer than
                five samples of the time to roll over a patch or a bump.
        """
        self._check()
        check_step("bumps", step, self.speed / min(self.patch, self.length), per_period=5)
        count = samples(self.duration, step)
        motion = self._road(step, count) if self.through == "direct" else self._cab(step, count)
        return floor_of(step, motion)

    def _check(self) -> None:
        if self.number > 1 and self.spacing < self.length:
            raise InputError(
                f"bumps: a spacing of {self.spacing:g} m is less than their length, so they would overlap; "
                f"permitted: at least {self.length:g} m"
            )
        passed = self.first + ((self.number - 1) * self.spacing + self.length + self.patch) / self.speed
        if passed > self.duration:
            raise InputError(
                f"bumps: the last is passed at {passed:.4g} s, after the run's end at {self.duration:g} s; "
                "lengthen duration, or lower first, number or spacing"
            )

    def _road(self, step: float, count: int) -> Motion:
        """Return the road under the patch; its acceleration is averaged over two steps, which keeps its integral."""
        ahead = self.speed * (clock(count + 2, step) - step - self.first)
        behind = ahead - self.patch
        elevation = (self._area(ahead) - self._area(behind)) / self.patch
        velocity = self.speed * (self._height(ahead) - self._height(behind)) / self.patch
        return Motion(elevation[1:-1], velocity[1:-1], np.diff(elevation, 2) / step**2)

    def _cab(self, step: float, count: int) -> Motion:
        # The Fourier transform is periodic: the vehicle has to come to rest before the next period begins.
        size = count + round(ring_down(self.vehicle) / step)
        road = rfft(self._road(step, size).displacement, norm="forward")
        return motion_of(road * floor_response(lines(road, size * step), self.vehicle), step, size, count)

    def _height(self, s: Array) -> Array:
        u = np.clip(s - self._passed(s) * self.spacing, 0.0, self.length) / self.length
        if self.shape == "half_sine":
            return self.height * np.sin(np.pi * u)
        return self.height / 2 * (1 - np.cos(2 * np.pi * u))

    def _area(self, s: Array) -> Array:
        passed = self._passed(s)
        u = np.clip(s - passed * self.spacing, 0.0, self.length) / self.length
        if self.shape == "half_sine":
            full = 2 / np.pi
            part = (1 - np.cos(np.pi * u)) / np.pi
        else:
            full = 0.5
            part = u / 2 - np.sin(2 * np.pi * u) / (4 * np.pi)
        return self.height * self.length * (passed * full + part)

    def _passed(self, s: Array) -> Array:
        return np.clip(np.floor(s / self.spacing), 0, self.number - 1)
