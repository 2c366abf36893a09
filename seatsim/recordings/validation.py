"""The error of a scenario over the runs of a recording against its uncertainty, after ASME V&V 20-2009."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from seatsim.metrics.motion import rms
from seatsim.recordings.error_budget import budget_errors
from seatsim.recordings.nuisance import list_varied, vary
from seatsim.recordings.recording import Recording
from seatsim.recordings.replay import replay_table, select_compared
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import written

_STEP = 0.1
"""Share of its tolerance by which a parameter is moved; the change is linear that far."""
_STANDARD = 1.0 / math.sqrt(3.0)
"""Standard uncertainty of a parameter over its tolerance, within which any value is equally likely."""


class Validation(NamedTuple):
    """Comparison error of a channel and the standard uncertainties that it is set against, RMS values in `unit`."""

    unit: str
    error: float
    u_num: float
    u_input: float
    u_d: float

    @property
    @written()
    def u_val(self) -> float:
        """`sqrt(u_num^2 + u_input^2 + u_d^2)`; an error that is not above it says nothing against the model."""
        return math.sqrt(self.u_num**2 + self.u_input**2 + self.u_d**2)


def validate(
    scenario: Scenario, recording: Recording, runs: Sequence[str], channels: Sequence[str]
) -> dict[str, Validation]:
    """Return the comparison error and the validation uncertainty of channels over all samples of runs.

    With E = S - D of each sample, simulation less data, RMS values over the samples in the unit of the channel are

        error = rms(E),    u_val^2 = u_num^2 + u_input^2 + u_d^2.

    u_num is what halving the step of the integration changes. u_input is what the noise of the recorded inputs and the
    tolerances of the parameters change: each parameter moved by 1/sqrt(3) of its tolerance to first order, the squares
    added; one that was fitted has no tolerance. u_d is the stated noise of the sensor. |error| beyond u_val is of the
    model (ASME V&V 20-2009, recalled).

    Raises:
        RunError: a simulation could not be carried to its end.
    """
    squares, rows = [], []
    for run in runs:
        tolerated = _carry_tolerances(scenario, recording, run)
        squares.append(
            [
                (each.comparison_error**2, each.u_num**2, each.u_input**2 + tolerated[each.channel], each.u_d**2)
                for each in budget_errors(scenario, recording, run, channels)
            ]
        )
        measured = select_compared(recording.table(run), recording.header.rig, recording.header.sample_rate)
        rows.append(len(measured[channels[0]]))
    pooled = np.sqrt(np.average(squares, axis=0, weights=rows))
    units = [recording.channels[name].unit for name in channels]
    return {name: Validation(unit, *row) for name, unit, row in zip(channels, units, pooled.tolist(), strict=True)}


def _carry_tolerances(scenario: Scenario, recording: Recording, run: str) -> dict[str, float]:
    """Return the mean square of what the tolerances of all parameters together change in each output of a run."""
    table, parameters = recording.table(run), list_varied(recording.header, scenario, fitted=0.0)

    def replay_moved(deviations: Array) -> dict[str, Array]:
        return replay_table(recording.scenario_of(run, vary(scenario, parameters, deviations)), recording, table)

    base = replay_moved(np.zeros(len(parameters)))
    moved = [replay_moved(row) for row in _STEP * np.eye(len(parameters))]
    change = _STANDARD / _STEP
    return {name: sum(rms(change * (each[name] - values)) ** 2 for each in moved) for name, values in base.items()}
