"""Properties of every damper and of its inverse over the whole space of its parameters.

A set is drawn within the bounds of the model's fields: over all of a bounded range, otherwise about the default, by a
factor of e^N(0, 0.5). A law in the current is drawn again while it falls below zero within the model's range: such a
damper is given damping or friction that pushes, and no model claims to dissipate then. Each set is moved through a
sine of random amplitude, frequency, current and temperature, and its inverse asked for a random force. Found may be:

    finite        forces that are not finite
    dissipative   cycles that return energy
    symmetric     forces that the mirrored motion does not mirror (of sets without an offset or an asymmetric part)
    inverse       currents whose force differs from the closest one by more than 1e-6 of the range
    least         currents above the least that serves
    refused       sets that the bench refuses with an error, as too stiff: no failure
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from seatsim.dampers.base import DamperSpecification
from seatsim.kernel.inverse import CELLS, CLOSE, SERVED, Demand, invert, total_force
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.schema.errors import RunError
from seatsim.schema.fields import bounds
from seatsim.schema.registry import find, names, specification_of
from seatsim.simulation.damper_bench import bench_force

SETS, SAMPLES, CYCLES = 4, 120, 2
FACTORS = TemperatureFactors(-0.004, -0.009, -0.014, 20.0)
GRID = 241
SAME = 1e-6
"""Share of the range of forces by which an inverse may be off; its own end of a search, in N, is added."""
ASYMMETRIC = ("f0", "f0_a", "f0_b", "x0", "mu", "asymmetry", "offset_share")
"""Fields that make a force asymmetric unless they are 0."""


class Case(NamedTuple):
    """One set of parameters with the sine it is moved through."""

    damper: object
    specification: DamperSpecification
    amplitude: float
    frequency: float
    current: float
    temperature: float


def draw_value(rng: np.random.Generator, default: float, low: float, high: float) -> float:
    """Return a value within its bounds: over all of a bounded range, otherwise about the default."""
    if math.isfinite(low) and math.isfinite(high):
        wide = low > 0 and high > 100 * low
        return float(math.exp(rng.uniform(math.log(low), math.log(high))) if wide else rng.uniform(low, high))
    return float(np.clip((default or rng.normal()) * math.exp(0.5 * rng.normal()), low, high))


def draw_law(rng: np.random.Generator, default: tuple[float, ...], most: float) -> tuple[float, ...]:
    """Return the coefficients of a law that is not negative up to the current `most`; the default after many tries."""
    for _ in range(100):
        law = tuple(float(c * math.exp(0.4 * rng.normal())) for c in default)
        if np.all(np.polynomial.polynomial.polyval(np.linspace(0.0, most, 33), law) >= 0.0):
            return law
    return default


def draw_case(rng: np.random.Generator, name: str) -> Case:
    """Return a random set of a model's parameters, and a sine within the range of its data."""
    cls = find("damper", name)
    specification = specification_of(cls)
    values: dict[str, object] = {}
    defaults: Mapping[str, object] = cls()._asdict()
    for field, default in defaults.items():
        if isinstance(default, tuple):
            values[field] = draw_law(rng, default, specification.max_current)
        elif isinstance(default, int):
            values[field] = round(rng.uniform(*bounds(cls, field)))
        else:
            values[field] = draw_value(rng, default, *bounds(cls, field))
    frequency = float(np.exp(rng.uniform(math.log(0.5), math.log(8.0))))
    amplitude = specification.max_speed * rng.uniform(0.05, 1.0) / (2 * math.pi * frequency)
    current, temperature = rng.uniform(0.0, specification.max_current), rng.uniform(0.0, 80.0)
    return Case(cls(**values), specification, amplitude, frequency, float(current), float(temperature))


def move(case: Case, sign: float = 1.0) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return the force in N over the whole sine, the velocity in m/s, and the step in s."""
    phase = math.pi / SAMPLES * np.arange(2 * CYCLES * SAMPLES + 1)
    x = sign * case.amplitude * np.sin(phase)
    v = sign * 2 * math.pi * case.frequency * case.amplitude * np.cos(phase)
    step = 1.0 / (case.frequency * SAMPLES)
    return bench_force(case.damper, x, v, case.current, case.temperature, step, FACTORS), v[::2], step


def check_motion(case: Case) -> list[str]:
    """Return the findings about a set that is moved."""
    try:
        force, v, step = move(case)
    except RunError as error:
        return ["refused" if "too stiff" in str(error) else "finite"]
    except OverflowError:
        return ["finite"]
    found = [] if np.all(np.isfinite(force)) else ["finite"]
    cycle = slice(-SAMPLES - 1, None)
    power = (force * v)[cycle]
    if np.trapezoid(power, dx=step) < -1e-4 * np.trapezoid(np.abs(power), dx=step):
        found.append("dissipative")
    values = case.damper._asdict()
    even = case._replace(damper=case.damper._replace(**{k: 0.0 for k in ASYMMETRIC if k in values}))
    there, back = (move(even, sign)[0] for sign in (1.0, -1.0))
    if np.max(np.abs(there + back)) > 1e-6 * np.max(np.abs(there)):
        found.append("symmetric")
    return found


def reach_state(case: Case, x: float, v: float, scaling: TemperatureScaling) -> tuple[float, ...]:
    """Return a state of the damper after 10 ms of steady motion, by short steps that cannot run away."""
    z = case.specification.initial
    for _ in range(100 if z else 0):
        rates = case.damper.rates(x, v, case.current, scaling, z)
        z = tuple(a + 1e-4 * b for a, b in zip(z, rates, strict=True))
    return z


def check_inverse(rng: np.random.Generator, case: Case) -> list[str]:
    """Return the findings about the inverse of a set, against a dense grid of currents."""
    top = case.specification.max_current * float(rng.choice([0.5, 0.8, 1.0]))
    scaling = TemperatureScaling(*rng.uniform(0.6, 1.2, 3))
    x, v = float(rng.uniform(-0.02, 0.02)), float(rng.uniform(-1, 1) * case.specification.max_speed)
    currents = np.linspace(0.0, top, GRID)
    try:
        z = reach_state(case, x, v, scaling)
        forces = np.array([total_force(case.damper, x, v, float(i), scaling, z) for i in currents])
    except OverflowError:
        return []
    span = float(np.ptp(forces))
    if not np.all(np.isfinite(forces)) or not 1e-3 < span < 1e6:
        return []
    wanted = float(rng.uniform(forces.min() - 0.2 * span, forces.max() + 0.2 * span))
    wanted = float(rng.choice(forces)) if rng.uniform() < 0.3 else wanted
    if wanted * v <= 0.0:
        return []
    answer = invert(Demand(case.damper, wanted, x, v, scaling, z, top), np.empty(CELLS + 1))
    miss, missed = abs(answer.force - wanted), np.abs(forces - wanted)
    if miss > (missed.min() if _crossing(forces, wanted) is None else 0.0) + SAME * span + CLOSE:
        return ["inverse"]
    first = _crossing(forces, wanted)
    serves = np.flatnonzero(missed <= miss - SERVED * span)
    late = serves[0] if first is None and len(serves) else first
    # One more interval is granted: where the force hardly changes, many currents serve within `CLOSE`.
    return ["least"] if late is not None and answer.current > currents[min(late + 2, GRID - 1)] else []


def _crossing(forces: NDArray[np.float64], wanted: float) -> int | None:
    """Return the first interval of the grid in which the wanted force lies, None where there is none."""
    found = np.flatnonzero((forces[1:] - wanted) * (forces[:-1] - wanted) <= 0.0)
    return int(found[0]) if len(found) else None


@pytest.mark.slow
@pytest.mark.parametrize("name", names("damper"))
def test_a_damper_is_finite_passive_symmetric_and_inverted_for_random_parameters(name: str) -> None:
    rng = np.random.default_rng([1, *name.encode()])
    for _ in range(SETS):
        case = draw_case(rng, name)
        with np.errstate(all="ignore"):
            found = set(check_motion(case) + check_inverse(rng, case)) - {"refused"}
        assert not found, case
