"""What of the operating range a recording did not visit: travels, currents, temperatures.

An effect outside the recorded range cannot be assessed, however good the data are.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from seatsim.recordings.recording import Recording
from seatsim.rig.temperature import Thermal
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array

_ENDS = (0.1, 99.9)
"""Percentiles of a quantity between which it was seen for more than an instant."""
_WARM = 5.0
"""K; least warming above the temperature of the nominal scenario at which thermal fade can be seen."""
_DROP, _DROP_TIME = 0.1, 0.2
"""Least drop of the current, as a share of the largest, and the seconds within which it must happen."""
_FULL_CURRENT = 0.8
"""Share of the largest current that must be visited."""
_LARGE_TRAVEL, _LIFT = 0.03, 1.0
"""m and m/s^2 that must be visited for stops and for the cushion in tension."""


class _VisitedRange(NamedTuple):
    """The least and the greatest value of a quantity over all runs in SI units, and those at its `_ENDS`."""

    low: float
    high: float
    lower: float
    upper: float


_Visited = dict[str, _VisitedRange]
"""Ranges by quantity."""


def list_unvisited(recording: Recording) -> Iterator[str]:
    """Yield a sentence for each part of the operating range that the runs did not visit, with what it leaves undecided.

    Raises:
        InputError: a table or the nominal scenario cannot be read.
    """
    pools: dict[str, list[Array]] = {}
    for run in recording.runs:
        for name, values in _quantities(recording, recording.table(run)).items():
            pools.setdefault(name, []).append(values)
    visited = {name: _measure_range(np.concatenate(parts)) for name, parts in pools.items()}
    yield from _missing_motion(recording, visited)
    drop = _largest_drop(pools.get("current", []), recording.header.sample_rate)
    yield from _missing_current(recording.nominal, visited.get("current"), drop)
    yield from _missing_temperature(recording.nominal, visited.get("temperature"))


def shows_falling_current(recording: Recording) -> bool:
    """Return whether the current falls enough somewhere to show what remembers it, or is not recorded at all."""
    runs = [_current(recording, recording.table(run)) for run in recording.runs]
    recorded = [current for current in runs if current is not None]
    least = _DROP * recording.nominal.coil.max_current
    return not recorded or _largest_drop(recorded, recording.header.sample_rate) >= least


def _quantities(recording: Recording, table: dict[str, Array]) -> dict[str, Array]:
    """Return the values of the quantities of one run by name."""
    found = {
        "travel": table.get("suspension_displacement", table.get("displacement")),
        "current": _current(recording, table),
        "temperature": table.get("damper_temperature"),
        "driver": table.get("driver_acceleration"),
    }
    return {name: values for name, values in found.items() if values is not None}


def _current(recording: Recording, table: dict[str, Array]) -> Array | None:
    """Return the current of the coil in A, the commanded one where that is not recorded; None without either."""
    for channel in ("coil_current", "current_command"):
        if channel in table:
            return table[channel]
    if "command_voltage" in table and recording.voltage_gain is not None:
        return recording.voltage_gain * table["command_voltage"]
    return None


def _measure_range(values: Array) -> _VisitedRange:
    return _VisitedRange(float(np.min(values)), float(np.max(values)), *np.percentile(values, _ENDS).tolist())


def _largest_drop(currents: Sequence[Array], rate: float) -> float:
    """Return the largest fall of a current within `_DROP_TIME` over all runs, in A."""
    rows = max(1, round(_DROP_TIME * rate))
    return max((float(np.max(current[:-rows] - current[rows:], initial=0.0)) for current in currents), default=0.0)


def _missing_motion(recording: Recording, visited: _Visited) -> Iterator[str]:
    travel, driver = visited.get("travel"), visited.get("driver")
    if travel is None:
        yield "no displacement is recorded: end stops, springs and free play are seen through other channels"
    elif recording.header.rig == "seat" and max(-travel.low, travel.high) < _LARGE_TRAVEL:
        place = f"travel stays within {1e3 * travel.low:.0f} to {1e3 * travel.high:.0f} mm"
        yield f"{place}: end stops and progressive springs beyond that cannot be assessed"
    if driver is not None and driver.low > -_LIFT:
        place = f"the driver is never accelerated downwards by more than {max(0.0, -driver.low):.2g} m/s^2"
        yield f"{place}: separation from the cushion cannot be assessed"


def _missing_current(nominal: Scenario, current: _VisitedRange | None, drop: float) -> Iterator[str]:
    most = nominal.coil.max_current
    if current is None:
        yield "no current is recorded: what the coil does cannot be assessed apart from the damper"
        return
    low, high = current.lower, current.upper
    if high - low < _DROP * most:
        yield f"current stays at {low:.2g} to {high:.2g} A: coil, remanence and saturation cannot be assessed"
        return
    if drop < _DROP * most:
        yield f"current never drops by more than {drop:.2g} A: remanence cannot be assessed"
    if high < _FULL_CURRENT * most:
        yield f"current never exceeds {high:.2g} A: magnetic saturation beyond that cannot be assessed"


def _missing_temperature(nominal: Scenario, temperature: _VisitedRange | None) -> Iterator[str]:
    stated = nominal.temperature.start if isinstance(nominal.temperature, Thermal) else nominal.temperature
    if temperature is None:
        yield "no temperature is recorded: thermal fade can only be seen as a weaker damper, not be told by its warmth"
    elif temperature.upper - stated < _WARM:
        yield f"no run is warmer than {temperature.upper:.0f} degC: thermal fade cannot be assessed"
