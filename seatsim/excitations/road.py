"""Random roads after ISO 8608, single bumps and rows of bumps, driven at constant speed.

Displacement spectrum of a road over the wavenumber n in cycles/m, one-sided, in m^3:

    Gd(n) = Gd(n0) * (n/n0)^-2,  n0 = 0.1 cycles/m

with the geometric means Gd(n0) = 16e-6 * 4^k m^3 for the classes A (k = 0) to H (k = 7). At speed V the wave
`n` is met with frequency `f = n*V`, and `G(f) = Gd(n0) n0^2 V / f^2`.

Source: ISO 8608, classes by geometric mean. The band of 0.011 to 2.83 cycles/m is the one commonly quoted
with that standard; it was not checked against its text.

A bump is a half-sine or a haversine:

    half_sine: z(s) = height * sin(pi s/length)
    haversine: z(s) = height/2 * (1 - cos(2 pi s/length))

for 0 <= s <= length. A tyre rests on a patch, so the road it follows is the mean over the patch length p,
`z_p(s) = (Z(s + p/2) - Z(s - p/2))/p`, Z the integral of z. The kink at the foot of a half-sine, which would be
an infinite acceleration in point contact, becomes a pulse of `V^2 z'/p` over the time `p/V`: finite, with the
correct area `V z'`.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, Literal, NamedTuple

import numpy as np
from scipy.fft import rfft

from seatsim.excitations import motion
from seatsim.excitations.base import Duration, Floor, Speed, Through, choice, excitation
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.fields import param

_LONGEST_RING_DOWN = 600.0


class Vehicle(NamedTuple):
    """One front wheel of a heavy truck with its share of body and cab on its mounts, from road zr to cab floor z0.

        axle:  mu*zu'' = kt*(zr - zu) + ks*(zb - zu) + cs*(zb' - zu')
        body:  mb*zb'' = ks*(zu - zb) + cs*(zu' - zb') + kc*(z0 - zb) + cc*(z0' - zb')
        cab:   mc*z0'' = kc*(zb - z0) + cc*(zb' - z0')

    Linear, one wheel, point contact: no pitch, no frame bending, no engine. Valid for ride up to about 20 Hz; by then
    the floor has lost nearly all of the road's content.

    The values are chosen by us, typical of a heavy truck; they are not from a published source. Coupled, they
    give modes at 1.15 Hz (body, 29 % of critical damping), 1.96 Hz (cab, 49 %) and 8.8 Hz (wheel, 53 %).
    """

    axle_mass: Annotated[float, param("kg", "unsprung mass at one wheel", above=0)] = 350.0
    body_mass: Annotated[float, param("kg", "frame and load carried by one wheel, without the cab", above=0)] = 2600.0
    cab_mass: Annotated[float, param("kg", "share of the cab above one wheel", above=0)] = 450.0
    tyre_stiffness: Annotated[float, param("N/m", "vertical stiffness of the tyre", above=0)] = 1.0e6
    suspension_stiffness: Annotated[float, param("N/m", "stiffness of the axle suspension", above=0)] = 2.0e5
    suspension_damping: Annotated[float, param("N s/m", "damping of the axle suspension", low=100)] = 2.0e4
    mount_stiffness: Annotated[float, param("N/m", "stiffness of the cab mounts", above=0)] = 5.0e4
    mount_damping: Annotated[float, param("N s/m", "damping of the cab mounts", low=100)] = 4.0e3


TRUCK = Vehicle()


def floor_response(frequency: Array, vehicle: Vehicle = TRUCK) -> motion.Spectrum:
    """Return the complex response `z0/zr` of the cab floor to the road, shape of `frequency`.

    Built from the cab down: a mass `m` on a spring with the transmissibility `T = (k + c s)/(m s^2 + k + c s)`
    adds `m T` to the mass below it; `z0/zr` is the product of the three T.

    Args:
        frequency: in Hz, any shape.
        vehicle: its parameters.
    """
    s = (2j * np.pi * frequency).astype(np.complex128)
    response = np.ones_like(s)
    carried = np.zeros_like(s)
    v = vehicle
    for mass, link in (
        (v.cab_mass, v.mount_stiffness + v.mount_damping * s),
        (v.body_mass, v.suspension_stiffness + v.suspension_damping * s),
        (v.axle_mass, v.tyre_stiffness + 0 * s),
    ):
        total = mass + carried
        transmissibility = link / (total * s**2 + link)
        carried = total * transmissibility
        response = response * transmissibility
    return response


def state_space(vehicle: Vehicle = TRUCK) -> tuple[Array, Array, Array, Array]:
    """Return `A (6,6)`, `B (6,1)`, `C (3,6)` and `D (3,1)` from the road to the floor.

    States: displacements of axle, body and cab in m, then their velocities in m/s. Made for
    `control.ss(*state_space())`.
    """
    v = vehicle
    masses = np.array([v.axle_mass, v.body_mass, v.cab_mass])
    stiffness = _chain(v.suspension_stiffness, v.mount_stiffness)
    stiffness[0, 0] += v.tyre_stiffness
    damping = _chain(v.suspension_damping, v.mount_damping)
    accelerations = -np.hstack([stiffness, damping]) / masses[:, None]
    A = np.vstack([np.hstack([np.zeros((3, 3)), np.eye(3)]), accelerations])
    B = np.zeros((6, 1))
    B[3, 0] = v.tyre_stiffness / v.axle_mass
    C = np.vstack([np.eye(6)[2], np.eye(6)[5], A[5]])
    return A, B, C, np.zeros((3, 1))


def ring_down(vehicle: Vehicle) -> float:
    """Return the time in s in which every free vibration of the vehicle falls below a millionth.

    Raises:
        InputError: it takes longer than ten minutes, so some stiffness or damping must be wrong.
    """
    slowest = np.linalg.eigvals(state_space(vehicle)[0]).real.max()
    if slowest > -np.log(1e6) / _LONGEST_RING_DOWN:
        raise InputError(
            f"vehicle {vehicle}: it still sways after {_LONGEST_RING_DOWN:g} s; "
            "check that stiffnesses are in N/m and dampings in N s/m"
        )
    return float(-np.log(1e6) / slowest)


def _chain(lower: float, upper: float) -> Array:
    return np.array([[lower, -lower, 0.0], [-lower, lower + upper, -upper], [0.0, -upper, upper]])


RoadClass = Literal["A", "B", "C", "D", "E", "F", "G", "H"]
_REFERENCE_WAVENUMBER = 0.1
LONGEST, SHORTEST = 0.011, 2.83
# Five of the longest waves, so that a short or slow run still has spectral lines down to the end of the band.
_LEAST_PERIOD = 5 / LONGEST


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
        motion.check_step("road", step, SHORTEST * self.speed, per_period=5)
        count = motion.samples(self.duration, step)
        # In whole seconds, so that the period, and thus the road, is the same for every step.
        size = max(count - 1, round(ceil(_LEAST_PERIOD / self.speed) / step))
        spectrum = _road(self.road_class, size * step * self.speed, SHORTEST, seed)
        if self.through == "vehicle":
            spectrum = spectrum * floor_response(motion.lines(spectrum, size * step), self.vehicle)
        return motion.soft_start(step, motion.motion_of(spectrum, step, size, count))


def displacement_density(wavenumber: Array, road_class: RoadClass) -> Array:
    """Return Gd(n) of a road class in m^3 at wavenumbers in cycles/m, shape of `wavenumber`."""
    roughness = 16e-6 * 4.0 ** "ABCDEFGH".index(road_class)
    return roughness * (np.asarray(wavenumber) / _REFERENCE_WAVENUMBER) ** -2


def _road(road_class: RoadClass, period: float, shortest: float, seed: int) -> motion.Spectrum:
    return motion.random_phase(lambda n: displacement_density(n, road_class), LONGEST, shortest, period, seed)


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
        motion.check_step("bumps", step, self.speed / min(self.patch, self.length), per_period=5)
        count = motion.samples(self.duration, step)
        return motion.floor_of(step, self._road(step, count) if self.through == "direct" else self._cab(step, count))

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

    def _road(self, step: float, count: int) -> motion.Motion:
        """Return the road under the patch; its acceleration is averaged over two steps, which keeps its integral."""
        ahead = self.speed * (motion.clock(count + 2, step) - step - self.first)
        (height, area), (height_behind, area_behind) = self._profile(ahead), self._profile(ahead - self.patch)
        elevation = (area - area_behind) / self.patch
        velocity = self.speed * (height - height_behind) / self.patch
        return motion.Motion(elevation[1:-1], velocity[1:-1], np.diff(elevation, 2) / step**2)

    def _cab(self, step: float, count: int) -> motion.Motion:
        # The Fourier transform is periodic: the vehicle has to come to rest before the next period begins.
        size = count + round(ring_down(self.vehicle) / step)
        road = rfft(self._road(step, size).displacement, norm="forward")
        return motion.motion_of(road * floor_response(motion.lines(road, size * step), self.vehicle), step, size, count)

    def _profile(self, s: Array) -> tuple[Array, Array]:
        """Return the elevation at s in m, and its integral up to there in m^2."""
        passed = np.clip(np.floor(s / self.spacing), 0, self.number - 1)
        u = np.clip(s - passed * self.spacing, 0.0, self.length) / self.length
        if self.shape == "half_sine":
            height, full, part = np.sin(np.pi * u), 2 / np.pi, (1 - np.cos(np.pi * u)) / np.pi
        else:
            height, full, part = (1 - np.cos(2 * np.pi * u)) / 2, 0.5, u / 2 - np.sin(2 * np.pi * u) / (4 * np.pi)
        return self.height * height, self.height * self.length * (passed * full + part)
