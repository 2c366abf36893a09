"""Forces inside a seat whose own response is linear: what they add to the recorded motion is integrated beside it.

With the rig's equations linear, the difference d of the motion with and without a force f obeys them alone:
`M d'' + C d' + K d = -f(x + d, v + d')`, where x is the recorded motion. So the background stays what was measured.
"""

import itertools
from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.linalg import expm
from scipy.signal import butter, sosfiltfilt

from seatsim.blind.carrier.recorded import Altered, Carrier, Change, Table, number, section, slope
from seatsim.schema.arrays import Array

_SUBSTEPS = 4
"""Of the integration in each row: friction is stiff."""
_Force = Callable[[float, float, float, float, float], tuple[float, float]]
"""Force on frame and driver from suspension x, v, cushion xc, vc and the driver's acceleration."""
_Putting = tuple[Mapping[str, float], Callable[[], _Force]]
"""True parameters, and what begins the force in a run: it remembers what went before."""


class _SeatMotion(NamedTuple):
    """Recorded motion: suspension x, v and cushion xc, vc, and the driver's acceleration, shape (N,) each."""

    x: Array
    v: Array
    xc: Array
    vc: Array
    driver: Array


def draw_seat_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return the changes of a seat whose nominal damper bears no yield force, so that the rig is linear."""
    if carrier.rig != "seat" or not _is_linear(carrier) or not {"floor_acceleration"} < set(carrier.channels):
        return []
    plant = {name: number(value) for name, value in section(carrier.nominal, "plant").items()}
    motions = {run: _motion(carrier, plant, table) for run, table in carrier.tables.items()}
    travel = float(np.std(np.concatenate([m.x for m in motions.values()])))
    peak = float(np.quantile(np.abs(np.concatenate([m.x for m in motions.values()])), 0.999))
    stiffness, mass = plant["suspension_stiffness"], plant["driver_mass"]
    force = stiffness * travel
    width = float(np.exp(rng.uniform(np.log(0.02), np.log(0.1)))) * travel
    stop = float(rng.uniform(0.4, 0.7)) * peak
    seed, step = int(rng.integers(2**31)), carrier.step

    def change(effect: str, form: str, largest: float, at: Callable[[float], _Putting]) -> Change:
        def alter(amount: float) -> Altered:
            parameters, begin = at(amount)
            tables = {
                run: {**table, **_respond(carrier, plant, table, motions[run], begin())}
                for run, table in carrier.tables.items()
            }
            return Altered(carrier._replace(tables=tables), parameters)

        return Change(effect, form, "", largest, alter)

    def rub(a: float) -> _Putting:
        return {"force": a * force}, partial(_rub, a * force, width)

    def stiffen(a: float) -> _Putting:
        return {"rise": a / travel**2}, partial(_cubic, a * stiffness / travel**2)

    def push(a: float) -> _Putting:
        return {}, partial(_random, a * force, np.random.default_rng(seed), step)

    return [
        change("suspension.friction", "F sgn v", 1.0, rub),
        change("suspension.progressive_spring", "cubic", 3.0, stiffen),
        change("suspension.end_stop", "linear buffer", 5.0, lambda a: ({}, partial(_buffer, a * stiffness, stop))),
        change("driver.mass", "heavier", 0.6, lambda a: ({"change": a * mass}, partial(_mass, a * mass))),
        change("floor.unmeasured_input", "random force on the frame", 3.0, push),
    ]


def _is_linear(carrier: Carrier) -> bool:
    values = section(section(carrier.nominal, "damper"), "parameters")
    return all(number(values.get(name, 0.0)) == 0.0 for name in ("alpha_a", "alpha_b", "fc_a", "fc_b"))


def _respond(
    carrier: Carrier, plant: Mapping[str, float], table: Table, motion: _SeatMotion, force: _Force
) -> dict[str, Array]:
    """Return the recorded outputs with what a force adds to them, shape (N,) each.

    The state is d = (frame, driver, their speeds) relative to the recorded motion; exact for a force held over a step.
    """
    step = carrier.step / _SUBSTEPS
    A, B = _matrices(plant)
    M = expm(np.block([[A, B], [np.zeros((2, 6))]]) * step)
    keep, drive = M[:4, :4], M[:4, 4:]
    d, rows = np.zeros(4), len(motion.x)
    added = {name: np.zeros(rows) for name in ("frame_acceleration", "driver_acceleration", "suspension_displacement")}
    for k in range(rows):
        for _ in range(_SUBSTEPS):
            relative = d[0], d[2], d[1] - d[0], d[3] - d[2]
            rates = A @ d
            suspension = motion.x[k] + relative[0], motion.v[k] + relative[1]
            cushion = motion.xc[k] + relative[2], motion.vc[k] + relative[3]
            f = np.array(force(*suspension, *cushion, motion.driver[k] + rates[3]))
            rates = rates + B @ f
            d = keep @ d + drive @ f
        added["suspension_displacement"][k] = d[0]
        added["frame_acceleration"][k], added["driver_acceleration"][k] = rates[2], rates[3]
    return {name: table[name] + values for name, values in added.items() if name in table}


def _matrices(plant: Mapping[str, float]) -> tuple[Array, Array]:
    ms, m = plant["frame_mass"], plant["driver_mass"]
    kf, cf, kc, cc = (plant[f"{part}_{law}"] for part in ("suspension", "cushion") for law in ("stiffness", "damping"))
    frame, driver = [-(kf + kc) / ms, kc / ms, -(cf + cc) / ms, cc / ms], [kc / m, -kc / m, cc / m, -cc / m]
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], frame, driver])
    return A, np.array([[0, 0], [0, 0], [1 / ms, 0], [0, 1 / m]])


def _motion(carrier: Carrier, plant: Mapping[str, float], table: Table) -> _SeatMotion:
    """Return the recorded motion; what is not recorded is that of the linear rig on the recorded floor."""
    step = carrier.step
    simulated = simulate_linear(plant, table["floor_acceleration"], step)
    x = table.get("suspension_displacement", simulated.x)
    v = slope(x, step) if "suspension_displacement" in table else simulated.v
    driver = table.get("driver_acceleration", simulated.driver)
    return _SeatMotion(x, v, simulated.xc, simulated.vc, driver)


def simulate_linear(plant: Mapping[str, float], floor: Array, step: float) -> _SeatMotion:
    """Return the motion of the linear rig relative to its floor, which is an inertial force on both masses."""
    A, _ = _matrices(plant)
    b = np.array([[0.0], [0.0], [-1.0], [-1.0]])
    M = expm(np.block([[A, b], [np.zeros((1, 5))]]) * step)
    d, found = np.zeros(4), np.empty((len(floor), 5))
    for k, a in enumerate(floor):
        found[k] = d[0], d[2], d[1] - d[0], d[3] - d[2], (A @ d)[3]
        d = M[:4, :4] @ d + M[:4, 4] * a
    return _SeatMotion(*found.T)


def _rub(force: float, width: float) -> _Force:
    anchor = 0.0

    def friction(x: float, v: float, xc: float, vc: float, driver: float) -> tuple[float, float]:
        nonlocal anchor
        anchor = min(max(anchor, x - width), x + width)
        return -force * (x - anchor) / width, 0.0

    return friction


def _cubic(rise: float) -> _Force:
    return lambda x, v, xc, vc, driver: (-rise * x**3, 0.0)


def _buffer(stiffness: float, stop: float) -> _Force:
    return lambda x, v, xc, vc, driver: (-stiffness * (max(0.0, x - stop) + min(0.0, x + stop)), 0.0)


def _mass(change: float) -> _Force:
    return lambda x, v, xc, vc, driver: (0.0, -change * driver)


def _random(size: float, rng: Generator, step: float) -> _Force:
    """Return a force with a spectrum between 1 and 8 Hz, another one in every run; it repeats after two minutes."""
    white = rng.standard_normal(round(120.0 / step))
    shaped = sosfiltfilt(butter(2, (1.0, 8.0), "bandpass", fs=1.0 / step, output="sos"), white)
    values = itertools.cycle(np.repeat(size * shaped / np.std(shaped), _SUBSTEPS))
    return lambda x, v, xc, vc, driver: (float(next(values)), 0.0)
