"""Data faults that are recognised by correcting them: the channels then fit the nominal rig far better.

A fault is named where its correction lowers the consistency residual (see `residual`) by much, and where the corrected
channel itself then fits. Correcting an input requires a new simulation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from seatsim.recordings.quality.faults import DataFault, exchange_fault, list_faults
from seatsim.recordings.quality.issue import Issue, Severity
from seatsim.recordings.quality.residual import consistency_residuals, simulate_nominal
from seatsim.recordings.quality.run_under_test import MOTION, RunUnderTest, Table

INPUTS = ("floor_acceleration", "displacement", "velocity", "current_command", "command_voltage")
"""Channels that drive the simulation."""
GROSS, DELAYED = 0.4, 0.2
"""Least fall of the residual for a fault to be named, and for a delay. A flipped sign raises e^2 of a channel by up to
2, a wrong unit by 1. Where mass, stiffness or damper of the nominal are far off, no correction gains more than 0.4."""
EXCHANGED, LEFT_BY_EXCHANGE = 0.002, 0.3
"""Residual of the coil from which currents may be exchanged, and largest share of it that undoing the exchange leaves.
A coil follows its command so closely that the right assignment leaves almost nothing."""
FITS = 0.1
"""Largest mean residual of the channels that a correction changed for them to fit. A fault of the data is exact: its
correction leaves what the rig differs from its nominal. An effect that resembles one leaves more."""
CHANGED = 0.05
"""Least change of a residual that counts as an influence of the correction."""
AS_GOOD = 0.1
"""Difference to the largest fall of the residual within which another fault explains the run equally well."""


def check_exchanged_currents(run: RunUnderTest) -> Iterator[Issue]:
    """Report a run in which the coil current follows the command much better once the two are exchanged."""
    fault = exchange_fault("current_command", "coil_current")
    if not set(fault.channels) <= set(run.table):
        return
    before = _coil_residual(run, run.table)
    if before > EXCHANGED and _coil_residual(run, fault.correct(run.table)) < min(LEFT_BY_EXCHANGE * before, FITS):
        yield _named(run, [fault])


def _coil_residual(run: RunUnderTest, table: Table) -> float:
    driving = {**run.table, "current_command": table["current_command"]}
    return consistency_residuals(run, table, simulate_nominal(run, driving))["coil_current"]


def check_consistency(run: RunUnderTest) -> Iterator[Issue]:
    """Name the fault whose correction lowers the residual of a run most, and those that lower it equally."""
    outputs = simulate_nominal(run, run.table)
    before = consistency_residuals(run, run.table, outputs)
    fall = {}
    for fault in _possible(run, before, outputs):
        table = fault.correct(run.table)
        inputs = {c: table[c] for c in INPUTS if c in table and table[c] is not run.table[c]}
        after = consistency_residuals(run, table, simulate_nominal(run, {**run.table, **inputs}) if inputs else outputs)
        if _explains(fault, before, after):
            fall[fault] = sum(before.values()) - sum(after.values())
    named = sorted((d for d in fall if fall[d] > max(fall.values()) - AS_GOOD), key=lambda fault: -fall[fault])
    if named:
        yield _named(run, named)


def _possible(run: RunUnderTest, before: Mapping[str, float], outputs: Table | None) -> Iterator[DataFault]:
    """Yield each fault that could explain such a residual; a fault of an input affects most outputs."""
    if sum(before.values()) < DELAYED:
        return
    is_driven_wrong = float(np.median([size for name, size in before.items() if name in MOTION])) > 0.5 * DELAYED
    for fault in list_faults(run, outputs):
        if is_driven_wrong or not set(INPUTS) & set(fault.channels):
            yield fault


def _explains(fault: DataFault, before: Mapping[str, float], after: Mapping[str, float]) -> bool:
    """Say whether the correction of a fault lowers the residual by much and makes the changed channels fit."""
    changed = [name for name in before if abs(before[name] - after[name]) > CHANGED]
    fall = sum(before.values()) - sum(after.values())
    is_large = fall >= (DELAYED if fault.kind == "late" else GROSS)
    return is_large and float(np.mean([after[name] for name in changed])) <= FITS


def _named(run: RunUnderTest, explanations: Sequence[DataFault]) -> Issue:
    """Return the issue for faults that explain a run equally well, the best first."""
    first, *others = explanations
    said = [f"{' and '.join(first.channels)}: {first.says}"]
    said += [f"{' and '.join(d.channels)} {d.says}" for d in others if d.channels != first.channels]
    mend = "correct it, in an import by the keys sign, unit or delay of the map, and compare again"
    if any(fault.may_be_effect for fault in explanations):
        mend = f"an effect may do this too; {mend} if it is none"
    severity: Severity = "warning" if any(fault.may_be_effect for fault in explanations) else "error"
    return Issue(severity, first.kind, f"{run.name}, {', or '.join(said)}; {mend}", first.channels[0], run.name)
