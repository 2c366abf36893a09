"""Why a run ended before its time: a law or a damper that gave no number, or a motion that left all bounds."""

from __future__ import annotations

import numpy as np

from seatsim.kernel.channels import CHANNELS
from seatsim.kernel.hooks import MOST_WORK
from seatsim.rig.control import LAWS
from seatsim.rig.temperature import scaling
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError
from seatsim.schema.registry import initial_state, is_own

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
