"""Why a run ended before its time, or cannot be relied on: no number, a range left, an open balance of energy."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from seatsim.kernel.hooks import MOST_WORK
from seatsim.kernel.loop_data import CHANNELS
from seatsim.metrics.table import Metric
from seatsim.metrics.weighting import least_rate
from seatsim.rig.control import LAWS
from seatsim.rig.plant import USUAL_TRAVEL
from seatsim.rig.temperature import scaling
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError
from seatsim.schema.registry import initial_state, is_own, name_of, specification_of
from seatsim.simulation.augment import augment_plant
from seatsim.simulation.damper_bench import centring
from seatsim.simulation.result import History

_SHARE = 0.01
"""Share of the run that may lie outside a range before it is worth a warning: a single peak changes no metric."""
LARGEST_RESIDUAL = 1e-3
"""Share of the energy that may be unaccounted for before the figures of a run cannot be relied on."""


def list_reasons(scenario: Scenario, history: History, metrics: Mapping[str, Metric]) -> tuple[str, ...]:
    """Return why the figures of a run are unverified; nothing where they can be relied on.

    A model was used outside the range of its data, a figure has no value, or more than `LARGEST_RESIDUAL` of the energy
    is unaccounted for. A driver of several masses has no energy balance, which is no reason by itself.
    """
    found = list(list_ranges_left(scenario, history))
    found += [f"{name} has no finite value" for name, metric in metrics.items() if not math.isfinite(metric.value)]
    residual = metrics.get("energy_residual")
    if residual is not None and residual.value > LARGEST_RESIDUAL:
        found.append(f"{residual.value:.2g} of the energy is unaccounted for; choose a smaller solver.step")
    return tuple(found)


def explain_unweighted(step: float, metrics: Mapping[str, Metric]) -> tuple[str, ...]:
    """Return why the figures of a run that the weighting by Wk needs are left out; nothing where they are there."""
    if "driver_acceleration_weighted" in metrics or "driver_acceleration_rms" not in metrics:
        return ()
    return (
        f"weighted figures (Wk RMS, VDV, SEAT factor) are left out: with solver.step {1e3 * step:g} ms there are"
        f" {1 / step:.4g} samples a second, and Wk needs {least_rate():g}; choose a step of"
        f" {1e3 / least_rate():g} ms or less",
    )


def list_ranges_left(scenario: Scenario, history: History) -> tuple[str, ...]:
    """Return a sentence for every range that a run leaves; those of the damper for more than 1 % of the time."""
    displacement, velocity = history["suspension_displacement"], history["suspension_velocity"]
    doubts = _doubt_travel(scenario, float(np.max(np.abs(displacement))))
    cls = type(scenario.damper.record)
    specification, model = specification_of(cls), name_of("damper", cls)
    ratio = scenario.plant.damper_ratio if scenario.plant else 1.0
    temperature, (coldest, hottest) = history["damper_temperature"], specification.temperatures
    # A command at the end of the laws may exceed it by rounding.
    fast = ratio * np.abs(velocity) > specification.max_speed
    strong = history["coil_current"] > specification.max_current * (1 + 1e-9)
    foreign = (temperature < coldest) | (temperature > hottest)
    degrees = f"not at {coldest:g} degC" if coldest == hottest else f"outside {coldest:g} to {hottest:g} degC"
    extrapolated = "the force there is an extrapolation"
    checks = (
        (fast, f"faster than {specification.max_speed:g} m/s", extrapolated),
        (strong, f"above {specification.max_current:g} A", "its laws end there"),
        (foreign, degrees, extrapolated),
    )
    found = [
        f"{model}: more than {_SHARE:.0%} of a run is {what}, beyond the data behind the model; {consequence}"
        for outside, what, consequence in checks
        if np.mean(outside) > _SHARE
    ]
    drift = centring(displacement, velocity) if specification.centred else ""
    return (*doubts, *found, *([f"{model}: {drift}"] if drift else []))


def _doubt_travel(scenario: Scenario, peak: float) -> tuple[str, ...]:
    """Return what is to be said where the suspension moves further than any seat does and no end stop is stated."""
    plant = scenario.plant
    if plant is None or augment_plant(scenario.effects, plant).end_stops or peak <= USUAL_TRAVEL[1]:
        return ()
    return (
        f"the suspension moves {1e3 * peak:.0f} mm from its mid-stroke, and seats have {1e3 * USUAL_TRAVEL[1]:.0f} mm"
        " at most; state plant.travel, and suspension.end_stop under effects",
    )


_FARTHEST = 10.0
"""m, as far as the travel of a seat may be stated; beyond it the motion itself has left all bounds."""


def explain_divergence(scenario: Scenario, out: Array, ratio: float) -> RunError:
    """Return the error of a run of which only the samples `out`, shape (N, len(CHANNELS)), were reached.

    `ratio` is the damper's stroke per travel of the suspension.
    """
    step, rows = scenario.solver.step, dict(zip(CHANNELS, out.T, strict=True))
    lost = np.flatnonzero(np.isnan(rows["current_command"]))
    if lost.size and scenario.control is not None:
        law = type(scenario.control.law)
        return RunError(
            f"{scenario.title}: the law '{LAWS.name_of(law)}' ({_name(law)}) gives no finite"
            f" number at {lost[0] * step:.6g} s; let it give one whatever it is told"
        )
    last = {name: float(values[-1]) for name, values in rows.items()}
    acceleration = last["frame_acceleration"] - last["floor_acceleration"]
    for time in (0.0, step):
        x = ratio * (last["suspension_displacement"] + time * last["suspension_velocity"])
        v = ratio * (last["suspension_velocity"] + time * acceleration)
        if not _is_finite(scenario, x, v, last["coil_current"], last["damper_temperature"]):
            return RunError(
                f"{scenario.title}: the damper {_name(type(scenario.damper.record))} gives no finite number at"
                f" {len(out) * step:.6g} s, where x = {x:.4g} m, v = {v:.4g} m/s and i = {last['coil_current']:.4g} A"
            )
    parts = (scenario.damper.record, *scenario.effects, *([scenario.control.law] if scenario.control else []))
    own = ", ".join(_name(type(part)) for part in parts if is_own(type(part))) or "the damper's parameters"
    return RunError(
        f"{scenario.title}: no solution beyond {(len(out) - 1) * step:.3f} s, where it leaves all bounds"
        f" or is too stiff (on average more than {MOST_WORK} parts of a step);"
        f" check the signs of gains and stiffnesses, and {own}"
    )


def _name(cls: type) -> str:
    return f"{cls.__module__}:{cls.__qualname__}"


def _is_finite(scenario: Scenario, x: float, v: float, i: float, temperature: float) -> bool:
    """Whether force and rates of the damper, in its state at rest, are finite for a motion that a seat may make."""
    damper, z = scenario.damper.record, initial_state(type(scenario.damper.record))
    factors = scaling(scenario.damper.factors, temperature)
    # As numbers of numpy, they divide by zero as compiled code does.
    x, v, i = np.float64(x), np.float64(v), np.float64(i)
    if not (np.all(np.isfinite([x, v, i])) and abs(x) < _FARTHEST):
        return True
    with np.errstate(all="ignore"):
        try:
            rates = damper.rates(x, v, i, factors, z) if hasattr(damper, "rates") else ()
            return bool(np.all(np.isfinite([damper.force(x, v, i, factors, z), *rates])))
        except (ArithmeticError, ValueError):
            return False
