"""Every number of docs/yu2019.md that a scenario file alone does not give.

python docs/yu2019/reproduction.py constants     the open constants, solved on model I's two figures and on K
python docs/yu2019/reproduction.py masses        the same for other drivers
python docs/yu2019/reproduction.py damping       model I's figures only, without the condition on K
python docs/yu2019/reproduction.py asymmetry     other degrees of asymmetry of the damper
python docs/yu2019/reproduction.py means         displacement with and without its mean
python docs/yu2019/reproduction.py settings      coil, controller, current limit, road
python docs/yu2019/reproduction.py conventional  Table 1, and the paper's eq 5 as model I
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares

from controllers import synthesise
from controllers.seat_plant import Weights, build_generalised_plant
from seatsim.dampers.yu import Yu2017, Yu2019
from seatsim.rig.plant import Plant
from seatsim.scenario.loading import load
from seatsim.scenario.scenario import DamperChoice, Inverse, Scenario
from seatsim.simulation.damper_bench import SineTest, sine_test
from seatsim.simulation.simulate import simulate

Array = NDArray[np.float64]
Settings = Mapping[str, Any]

STUDY = Path(__file__).resolve().parents[2] / "scenarios" / "yu2019" / "study.yaml"
GAIN = (2.0, 2147.6)
MODELS = ("I", "II", "III")
PUBLISHED = {"I": (0.908, 4.7), "II": (0.965, 5.6), "III": (0.878, 3.9)}
"""Driver acceleration in m/s^2 and displacement in mm, RMS at 80 degC."""


class Figures(NamedTuple):
    """RMS of the driver's acceleration in m/s^2; RMS and mean of the suspension displacement in mm."""

    acceleration: float
    displacement: float
    mean: float


class Seat(NamedTuple):
    """The constants that are solved for: N/m, N s/m, m/s, and the weight e1 for which K is the optimum."""

    stiffness: float
    damping: float
    speed: float
    weight: float = float("nan")

    def settings(self) -> dict[str, float]:
        """Return them as settings of the study."""
        return {
            "plant.suspension_stiffness": self.stiffness,
            "plant.suspension_damping": self.damping,
            "excitation.speed": self.speed,
        }


def figures(scenario: Scenario) -> Figures:
    """Return the figures of one run; the RMS of the displacement includes its mean."""
    history = simulate(scenario)
    acceleration, x = history["driver_acceleration"], history["suspension_displacement"]
    return Figures(float(np.sqrt(np.mean(acceleration**2))), 1e3 * float(np.sqrt(np.mean(x**2))), 1e3 * float(x.mean()))


def scenarios(settings: Settings, temperature: float = 80.0) -> dict[str, Scenario]:
    """Return the study's three models at one temperature, under other settings."""
    return {str(s.label["variant"]): s for s in load(STUDY, {**settings, "temperature": [temperature]})}


def with_damper(scenario: Scenario, record: Yu2019) -> Scenario:
    """Return a scenario with other damper coefficients, in the plant and, symmetric for model I, in the inverse."""
    assert scenario.control is not None and scenario.control.inverse is not None
    inverse = scenario.control.inverse
    believed = record._replace(asymmetry=inverse.damper.record.asymmetry)
    inverse = replace(inverse, damper=replace(inverse.damper, record=believed))
    control = replace(scenario.control, inverse=inverse)
    return replace(scenario, damper=replace(scenario.damper, record=record), control=control)


def study_damper() -> Yu2019:
    """Return the study's damper, whose backbones P and N stand in the ratio 1.1 to 0.9."""
    damper = scenarios({})["III"].damper.record
    assert isinstance(damper, Yu2019)
    return damper


def asymmetric(part: float) -> Yu2019:
    """Return the study's damper with backbones P and N in the ratio (1 + part) to (1 - part)."""
    damper = study_damper()
    p: Any = tuple(c * (1 + part) / 1.1 for c in damper.p)
    n: Any = tuple(c * (1 - part) / 0.9 for c in damper.n)
    return damper._replace(p=p, n=n)


@cache
def seats_of_gain(mass: float, weight: float) -> tuple[float, float]:
    """Return the suspension's stiffness and damping for which the published K is the H-infinity optimum.

    Feedback of displacement and velocity adds to spring and damper, so the optimum fixes only the sums `kf + k1` and
    `cf + k2`: one synthesis, for any seat, gives them.
    """
    start = Plant(20.0, mass, 4000.0, 200.0, 60000.0, 1500.0)
    gain = synthesise(build_generalised_plant(start, Weights(travel=weight))).gain
    return 4000.0 + float(gain[0, 0]) - GAIN[0], 200.0 + float(gain[0, 1]) - GAIN[1]


def speed_for(seat: Seat, settings: Settings, damper: Yu2019) -> Seat:
    """Return the seat at the speed that gives model I's acceleration: it grows with the root of the speed."""
    for _ in range(3):
        found = _model_one(seat, settings, damper).acceleration
        seat = seat._replace(speed=seat.speed * (PUBLISHED["I"][0] / found) ** 2)
    return seat


def excess(seat: Seat, settings: Settings, damper: Yu2019) -> float:
    """Return model I's displacement over the published one, less 1, where its acceleration is the published one."""
    return _model_one(speed_for(seat, settings, damper), settings, damper).displacement / PUBLISHED["I"][1] - 1.0


def solved_with_gain(mass: float, settings: Settings, damper: Yu2019 | None = None) -> Seat:
    """Return stiffness, damping and speed from model I's two figures and from K being the optimum."""
    settings, damper = {**settings, "plant.driver_mass": mass}, damper or study_damper()

    def seat(weight: float) -> Seat:
        return Seat(*seats_of_gain(mass, weight), 14.0, weight)

    softest = 1.0
    while seat(softest).damping < 0.0:
        softest *= 1.1
    weight = brentq(lambda w: excess(seat(w), settings, damper), softest, 50.0, xtol=1e-3)
    return speed_for(seat(weight), settings, damper)


def solved(mass: float, damping: float, settings: Settings, damper: Yu2019 | None = None) -> Seat:
    """Return stiffness and speed from model I's two figures, for a given damping."""
    settings, damper = {**settings, "plant.driver_mass": mass}, damper or study_damper()

    def seat(stiffness: float) -> Seat:
        return Seat(stiffness, damping, 14.0)

    stiffness = brentq(lambda k: excess(seat(k), settings, damper), 800.0, 25000.0, xtol=1.0)
    return speed_for(seat(stiffness), settings, damper)


def _model_one(seat: Seat, settings: Settings, damper: Yu2019) -> Figures:
    return figures(with_damper(scenarios({**settings, **seat.settings()})["I"], damper))


def row(settings: Settings, damper: Yu2019 | None = None) -> str:
    """Return the three models at 80 degC as text, with their errors against the paper."""
    cells = []
    for name, scenario in scenarios(settings).items():
        got = figures(with_damper(scenario, damper or study_damper()))
        errors = [100 * (ours / paper - 1) for ours, paper in zip(got[:2], PUBLISHED[name], strict=True)]
        cells.append(f"{name} {got.acceleration:.3f} {got.displacement:.2f} ({errors[0]:+.1f} {errors[1]:+.1f} %)")
    return " | ".join(cells)


def constants() -> None:
    """Print the study's own constants."""
    seat = solved_with_gain(80.0, {})
    print(f"kf {seat.stiffness:.0f} N/m, cf {seat.damping:.1f} N s/m, {seat.speed:.2f} m/s, e1 {seat.weight:.2f} 1/s^2")


def masses() -> None:
    """Print the constants and the predictions for other drivers."""
    for mass in (70.0, 80.0, 90.0, 100.0, 120.0):
        seat = solved_with_gain(mass, {})
        print(
            f"m {mass:.0f}: kf {seat.stiffness:.0f} cf {seat.damping:.0f} V {seat.speed:.2f} e1 {seat.weight:.1f}: ",
            end="",
        )
        print(row({"plant.driver_mass": mass, **seat.settings()}))


def damping() -> None:
    """Print the predictions where only model I's figures are met and the suspension's own damping is assumed."""
    for mass in (60.0, 80.0, 100.0):
        for own in (0.0, 200.0, 400.0):
            seat = solved(mass, own, {})
            print(f"m {mass:.0f} cf {own:.0f}: kf {seat.stiffness:.0f} V {seat.speed:.2f}: ", end="")
            print(row({"plant.driver_mass": mass, **seat.settings()}))


def asymmetry() -> None:
    """Print the predictions for other degrees of asymmetry, at the study's mass and damping."""
    for part in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5):
        damper = asymmetric(part)
        seat = solved(80.0, 191.0, {}, damper)
        r2, md, _ = indices(loops(damper), loops(damper._replace(asymmetry=0.0)))
        print(
            f"{part:.2f} (symmetric part R2 {r2:.4f} MD {md:.3f}): kf {seat.stiffness:.0f} V {seat.speed:.2f}: ", end=""
        )
        print(row(seat.settings(), damper))


def means() -> None:
    """Print the displacement with and without its mean at every temperature, in mm."""
    for temperature in (20.0, 40.0, 60.0, 80.0):
        for name, scenario in scenarios({}, temperature).items():
            got = figures(scenario)
            spread = (got.displacement**2 - got.mean**2) ** 0.5
            print(
                f"{temperature:.0f} degC {name}: {got.displacement:.2f}, mean {got.mean:+.2f}, without it {spread:.2f}"
            )


def settings() -> None:
    """Print the predictions under other settings, the seat and the road left as they are."""
    changes: dict[str, dict[str, Any]] = {
        "as in study.yaml": {},
        "coil rate 2000 1/s": {"actuator.rate": 2000.0},
        "coil rate 50 1/s": {"actuator.rate": 50.0},
        "sample time 10 ms": {"controller.sample_time": 0.01},
        "current to 0.8 A": {"actuator.max_current": 0.8},
        "current to 2.0 A": {"actuator.max_current": 2.0},
        "cushion 30 kN/m": {"plant.cushion_stiffness": 30000.0},
        "another road": {"seed": 2},
    }
    for name, change in changes.items():
        print(f"{name}: {row(change)}")


def indices(test: Array, model: Array) -> tuple[float, float, float]:
    """Return R2, MD and RMSE in N of the paper's eqs 6 to 8."""
    error = test - model
    r2 = 1.0 - np.sum(error**2) / np.sum((test - test.mean()) ** 2)
    return float(r2), float(np.mean(np.abs(error / test))), float(np.sqrt(np.mean(error**2)))


def conventional_fit(damper: Yu2019) -> tuple[Yu2017, tuple[float, float, float]]:
    """Return eq 5 fitted to a damper's loops over the paper's bench tests at 20 degC, and its indices."""
    tests = bench_tests(damper)
    force, v, x = (
        np.concatenate([getattr(t, name)[:-1] for t, _ in tests]) for name in ("force", "velocity", "displacement")
    )
    size = len(tests[0][0].force) - 1
    current = np.repeat([i for _, i in tests], size)
    peak = np.repeat([t.velocity.max() for t, _ in tests], size)
    branch, speed = np.tanh(x / 5e-4), np.abs(v)

    def model(q: Array) -> Array:
        height = q[0] + q[1] / (1.0 + np.exp(-np.exp(q[2]) * peak)) + q[3] * np.exp(q[4] * current)
        backbone = (1.0 - np.exp(-np.exp(q[5]) * speed)) / (1.0 + np.exp(-np.exp(q[6]) * speed)) * np.sign(v)
        return np.asarray(height * (backbone + q[7] * np.exp(-(v**2) / np.exp(q[8])) * branch))

    def miss(q: Array) -> Array:
        return np.asarray(model(q) - force)

    first = (600.0, 100.0, np.log(39.0), -550.0, -0.3, 4.0, 3.0, 0.3, np.log(1e-4))
    q = least_squares(miss, first, x_scale=np.maximum(np.abs(first), 0.1), max_nfev=5000).x
    found = Yu2017(q[0], q[1], -np.exp(q[2]), q[3], q[4], -np.exp(q[5]), -np.exp(q[6]), q[7], 0.0, np.exp(q[8]))
    return found, indices(force, model(q))


def conventional() -> None:
    """Print eq 5 fitted to the damper, its indices, and the study with it as model I's inverse."""
    found, (r2, md, rmse) = conventional_fit(study_damper())
    print({name: float(f"{value:.4g}") for name, value in found._asdict().items()})
    print(f"R2 {r2:.4f}, MD {md:.4f}, RMSE {rmse:.1f} N")
    scenario = scenarios({})["I"]
    assert scenario.control is not None
    inverse = Inverse(DamperChoice(found, scenario.damper.factors), None)
    got = figures(replace(scenario, control=replace(scenario.control, inverse=inverse)))
    print(f"80 degC: {got.acceleration:.3f} m/s^2, {got.displacement:.2f} mm, mean {got.mean:+.2f} mm")


def bench_tests(damper: Yu2019) -> list[tuple[SineTest, float]]:
    """Return the paper's bench tests of a damper at 20 degC, each with its current in A."""
    return [
        (sine_test(damper, x, f, i, 20.0, cycles=5, samples=200), i)
        for x in (0.004, 0.006, 0.008) for f in (0.5, 0.6, 0.7) for i in (0.0, 0.4, 0.8, 1.2)
    ]  # fmt: skip


def loops(damper: Yu2019) -> Array:
    """Return the force in N over all bench tests."""
    return np.concatenate([test.force[:-1] for test, _ in bench_tests(damper)])


PARTS = (constants, masses, damping, asymmetry, means, settings, conventional)

if __name__ == "__main__":
    chosen = [part for part in PARTS if part.__name__ in sys.argv[1:]]
    if not chosen:
        sys.exit(__doc__)
    for part in chosen:
        part()
