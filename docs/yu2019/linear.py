"""The linear argument of docs/yu2019.md: what a third less damping does to acceleration and displacement.

python docs/yu2019/linear.py floors     the ratio of model II to III, by floor and spring, and the best damping
python docs/yu2019/linear.py bounds     the largest ratio that any floor can give
python docs/yu2019/linear.py signs      the paper's signs, and its eq 15
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from seatsim.excitations.iso7096 import acceleration_density
from seatsim.excitations.road import LONGEST, SHORTEST, RoadClass, displacement_density, floor_response
from seatsim.rig.plant import Plant, PlantMatrices, state_space

Array = NDArray[np.float64]
Density = Callable[[Array], Array]

SEAT = Plant(20.0, 80.0, 3800.0, 191.0, 60000.0, 1500.0)
GAIN = (2.0, 2147.6)
LEFT_AT_80 = 0.67
"""Share of the damper's force that is left at 80 degC, hence of what model II delivers."""
SPRINGS = (2000.0, 3800.0, 6500.0, 8000.0, 12000.0, 20000.0)
FREQUENCY = np.geomspace(0.05, 60.0, 3000)


class Pair(NamedTuple):
    """Driver acceleration and suspension displacement: responses to the floor's acceleration, or RMS values."""

    acceleration: Array
    displacement: Array


def response(plant: Plant, served: float, frequency: Array = FREQUENCY) -> Pair:
    """Return the responses to the floor's acceleration, where the damper serves a share of `K (x, v)`."""
    s = state_space(plant)
    a = s.A + served * s.B2 @ np.array([GAIN]) @ s.C2
    resolvent = np.linalg.solve(2j * np.pi * frequency[:, None, None] * np.eye(4) - a, s.B1[None])
    displacement, acceleration = np.abs(s.C1 @ resolvent)[:, :, 0].T
    return Pair(acceleration, displacement)


def rms(plant: Plant, served: float, density: Density) -> Pair:
    """Return the RMS values on a floor with a one-sided acceleration density in (m/s^2)^2/Hz."""
    floor = density(FREQUENCY)
    return Pair(*(np.sqrt(np.trapezoid(floor * gain**2, FREQUENCY)) for gain in response(plant, served)))


def ratio(plant: Plant, density: Density) -> Pair:
    """Return what model II has over what model III has at 80 degC."""
    ours, theirs = rms(plant, LEFT_AT_80, density), rms(plant, 1.0, density)
    return Pair(ours.acceleration / theirs.acceleration, ours.displacement / theirs.displacement)


class Bound(NamedTuple):
    """Largest ratios of model II to III on any floor, and the frequency in Hz of that of the acceleration."""

    acceleration: float
    frequency: float
    displacement: float


def bound(plant: Plant) -> Bound:
    """Return what no floor exceeds.

    A ratio of variances on a floor is a mean of the squared ratios of the responses, weighted with a positive
    spectrum; a narrow band comes as close as one likes to the largest.
    """
    two, three = response(plant, LEFT_AT_80), response(plant, 1.0)
    acceleration, displacement = two.acceleration / three.acceleration, two.displacement / three.displacement
    worst = int(np.argmax(acceleration))
    return Bound(float(acceleration[worst]), float(FREQUENCY[worst]), float(np.max(displacement)))


def least_spring(plant: Plant, wanted: float) -> float:
    """Return the softest spring in N/m with which some floor gives model II that much more acceleration than III."""

    def excess(stiffness: float) -> float:
        return bound(plant._replace(suspension_stiffness=stiffness)).acceleration - wanted

    return float(brentq(excess, 500.0, 1e5))


def best_damping(plant: Plant, density: Density) -> float:
    """Return the total damping `cf + k2` in N s/m with the least driver acceleration, to 5 %."""
    totals = np.geomspace(50.0, 20000.0, 121)
    plants = [plant._replace(suspension_damping=total) for total in totals]
    return float(totals[np.argmin([rms(p, 0.0, density).acceleration for p in plants])])


def road(road_class: RoadClass, speed: float, through: str) -> Density:
    """Return the acceleration density of the floor on an ISO 8608 road, directly or through the default truck."""

    def density(f: Array) -> Array:
        inside = (f >= LONGEST * speed) & (f <= SHORTEST * speed)
        elevation = displacement_density(f / speed, road_class) / speed
        passed = np.abs(floor_response(f)) ** 2 if through == "vehicle" else 1.0
        return np.where(inside, elevation * passed * (2.0 * np.pi * f) ** 4, 0.0)

    return density


def narrow(frequency: float) -> Density:
    """Return a band about a frequency in Hz with a standard deviation of 5 % of it."""
    return lambda f: np.exp(-0.5 * ((f / frequency - 1.0) / 0.05) ** 2)


FLOORS: Mapping[str, Density] = {
    "road, directly": road("C", 14.16, "direct"),
    "road, truck cab": road("C", 14.16, "vehicle"),
    "ISO 7096 EM1": lambda f: acceleration_density(f, "EM1"),
    "ISO 7096 EM5": lambda f: acceleration_density(f, "EM5"),
    "ISO 7096 EM8": lambda f: acceleration_density(f, "EM8"),
    "narrow band, 1.0 Hz": narrow(1.0),
    "narrow band, 1.4 Hz": narrow(1.4),
    "narrow band, 2.0 Hz": narrow(2.0),
}


def literal(plant: Plant) -> Mapping[str, Array]:
    """Return the closed-loop matrices of the control part as printed.

    `eqs 13, 18` has u = -K y in the frame's equation, where -u stands; `eq 19` is A + B2 K C2 with the printed A
    and the printed B2 = +1/ms; `opposing` is what this package simulates, on the exact plant.
    """
    exact, printed = state_space(plant), state_space(plant, "yu2019")
    k = np.array([GAIN])

    def closed(s: PlantMatrices, sign: float) -> Array:
        return np.asarray(s.A + sign * s.B2 @ k @ s.C2)

    return {"eqs 13, 18": closed(exact, -1.0), "eq 19": closed(printed, -1.0), "opposing": closed(exact, 1.0)}


def acceleration_of_eq_15(plant: Plant, served: float) -> Array:
    """Return the response zc''/zs'' of eq 15, where the frame's acceleration is an outside disturbance."""
    s = state_space(plant, "yu2019")
    a = s.A + served * s.B2 @ np.array([GAIN]) @ s.C2
    resolvent = np.linalg.solve(2j * np.pi * FREQUENCY[:, None, None] * np.eye(4) - a, s.B1[None])
    return np.asarray(np.abs((s.C1 @ resolvent)[:, 1, 1]))


def floors() -> None:
    """Print the ratios for every floor and spring, and the best damping."""
    for name, density in FLOORS.items():
        cells = []
        for k in SPRINGS:
            plant = SEAT._replace(suspension_stiffness=k)
            r, best = ratio(plant, density), best_damping(plant, density)
            cells.append(f"{k:.0f}: {r.acceleration:.3f} {r.displacement:.3f} ({best:.0f})")
        print(f"{name}: " + " | ".join(cells))


def bounds() -> None:
    """Print the bounds for every spring, and the softest spring for the paper's ratio."""
    for k in SPRINGS:
        b = bound(SEAT._replace(suspension_stiffness=k))
        print(f"{k:.0f}: acceleration {b.acceleration:.3f} at {b.frequency:.2f} Hz, displacement {b.displacement:.3f}")
    for mass in (60.0, 80.0, 100.0):
        springs = [
            least_spring(SEAT._replace(driver_mass=mass, suspension_damping=c), 0.965 / 0.878)
            for c in (0.0, 191.0, 400.0)
        ]
        print(f"m {mass:.0f}: 1.099 needs " + ", ".join(f"{k:.0f}" for k in springs) + " N/m with cf 0, 191, 400 N s/m")


def signs() -> None:
    """Print the largest real part of the closed loops, and how far K moves the acceleration of eq 15."""
    for name, matrix in literal(SEAT).items():
        print(f"{name}: largest real part {np.linalg.eigvals(matrix).real.max():+.2f} 1/s")
    moved = np.max(np.abs(acceleration_of_eq_15(SEAT, 5.0) / acceleration_of_eq_15(SEAT, 0.0) - 1.0))
    print(f"eq 15: the acceleration's response changes by {moved:.1e} from K = 0 to 5 K")


PARTS = (floors, bounds, signs)

if __name__ == "__main__":
    chosen = [part for part in PARTS if part.__name__ in sys.argv[1:]]
    if not chosen:
        sys.exit(__doc__)
    for part in chosen:
        part()
