"""Damages that are told by undoing them: what the channels of a run say then contradicts the nominal rig far less.

A damage is named where undoing it lowers the misfit (see `misfit`) grossly, and where the channel itself then fits.
Undoing one on an input takes a new simulation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from seatsim.recordings.quality.faults import Damage, damages, exchange
from seatsim.recordings.quality.issue import MOTION, Finding, Run, Severity, Table
from seatsim.recordings.quality.residual import misfits, simulated

INPUTS = ("floor_acceleration", "displacement", "velocity", "current_command", "command_voltage")
"""Channels that drive the simulation."""
GROSS, DELAYED, EXCHANGED = 0.4, 0.2, 0.002
"""Fall of the misfit from which a damage is named; for a delay; misfit of the coil that asks for exchanged currents."""


def exchanged_currents(run: Run) -> Iterator[Finding]:
    """Say where the coil follows from the command much better once the two are exchanged."""
    damage = exchange("current_command", "coil_current")
    if not set(damage.channels) <= set(run.table):
        return
    before, after = (_misfit_of_coil(run, table) for table in (run.table, damage.undo(run.table)))
    if before > EXCHANGED and after < 0.3 * before:
        yield _named(run, [damage])


def _misfit_of_coil(run: Run, table: Table) -> float:
    return misfits(run, table, simulated(run, {"current_command": table["current_command"]}))["coil_current"]


def contradictions(run: Run) -> Iterator[Finding]:
    """Name the damage whose undoing lowers the misfit of a run most, and those that do it as well."""
    outputs = simulated(run, {})
    before = misfits(run, run.table, outputs)
    fall = {}
    for damage in _possible(run, before, outputs):
        table = damage.undo(run.table)
        inputs = {c: table[c] for c in INPUTS if c in table and table[c] is not run.table[c]}
        after = misfits(run, table, simulated(run, inputs) if inputs else outputs)
        if _explains(damage, before, after):
            fall[damage] = sum(before.values()) - sum(after.values())
    named = sorted((d for d in fall if fall[d] > max(fall.values()) - 0.1), key=lambda damage: -fall[damage])
    if named:
        yield _named(run, named)


def _possible(run: Run, before: Mapping[str, float], outputs: Table | None) -> Iterator[Damage]:
    """Yield each damage that could explain such a misfit; one on what drives the rig leaves few outputs alone."""
    if sum(before.values()) < DELAYED:
        return
    is_driven_wrong = float(np.median([size for name, size in before.items() if name in MOTION])) > 0.5 * DELAYED
    for damage in damages(run, outputs):
        if is_driven_wrong or not set(INPUTS) & set(damage.channels):
            yield damage


def _explains(damage: Damage, before: Mapping[str, float], after: Mapping[str, float]) -> bool:
    """Say whether undoing a damage lowers the misfit grossly, and what it changed then fits."""
    changed = [name for name in before if abs(before[name] - after[name]) > 0.05]
    limit, left = (DELAYED, 0.1) if damage.kind == "late" else (GROSS, 0.5)
    fall = sum(before.values()) - sum(after.values())
    return fall >= limit and float(np.mean([after[name] for name in changed])) <= left


def _named(run: Run, explanations: Sequence[Damage]) -> Finding:
    """Return the finding for damages that explain a run equally well, the best first."""
    first, *others = explanations
    said = [f"{' and '.join(first.channels)}: {first.says}"]
    said += [f"{' and '.join(d.channels)} {d.says}" for d in others if d.channels != first.channels]
    text = f"{run.name}, {', or '.join(said)}; correct it and diagnose again"
    severity: Severity = "warning" if first.kind == "late" and first.channels == ("coil_current",) else "error"
    return Finding(severity, first.kind, text, first.channels[0], run.name)
