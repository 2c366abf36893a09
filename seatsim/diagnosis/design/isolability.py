"""Structural isolability: which blocks of a rig a set of recorded channels can tell apart at all.

The rig is written as equations, each a set of unknowns, with the block whose fault enters it. An equation can be tested
where it lies in the structurally overdetermined part M+ of the Dulmage-Mendelsohn decomposition: the part that is
reached by alternating paths from the equations that a maximum matching leaves unmatched. A fault in block i can be
distinguished from one in block j where equation i stays in M+ after equation j is removed. As each fault enters one
equation, being indistinguishable is an equivalence relation, whose classes are the groups. Derivatives may be used in
both directions, and initial states are known (a replay starts at rest).

Sources: Dulmage and Mendelsohn 1958 (decomposition); Krysander and Frisk 2008, "Sensor placement for fault diagnosis"
(isolability from M+); equations of the seat as in section 1 of the recording's contract. Structural isolability holds
for faults of any form. Blocks of one group may still be distinguished by the form of the effects (friction is no
viscous damping), and faults of two groups may be too small to be distinguished on a given recording.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from seatsim.schema.fields import read_packaged
from seatsim.schema.text import join_names


class Equation(NamedTuple):
    """An equation of a rig: its unknowns, and the block whose fault enters it (None: it cannot be wrong)."""

    unknowns: frozenset[str]
    fault: str | None = None


class _Structure(NamedTuple):
    """Equations of a rig without coil and sensors, its blocks in order, and what to do about an absent channel."""

    equations: list[Equation]
    blocks: list[str]
    remedies: dict[str, str]


_RIGS = read_packaged(Path(__file__).with_name("structure.yaml"), dict[str, _Structure])
"""By kind of rig."""
_SENSED = {
    "floor_acceleration": "a0",
    "frame_acceleration": "as",
    "driver_acceleration": "ac",
    "suspension_displacement": "x",
    "displacement": "x",
    "velocity": "v",
    "damper_force": "Fd",
    "coil_current": "i",
}
"""The unknown that each sensor measures; the command and the temperature are known inputs."""


def find_isolable_groups(rig: str, channels: Collection[str]) -> list[list[str]]:
    """Return the groups of blocks that these channels can distinguish, in the order of the rig's blocks.

    Blocks of one group cannot be distinguished by structure. A block in no group enters no test: its faults leave no
    trace in these channels. `sensor` joins the first group with a block that a fault of some sensor cannot be
    distinguished from.
    """
    equations = _equations(rig, channels)
    faults = {k: equations[k].fault for k in sorted(_find_overdetermined(equations))}
    blocks, classes = {k: fault.split()[0] for k, fault in faults.items() if fault}, list[set[int]]()
    for k in blocks:
        home = next((c for c in classes if not _is_isolable(equations, min(c), k)), None)
        if home is None:
            classes.append({k})
        else:
            home.add(k)
    order = _RIGS[rig].blocks
    groups = sorted((sorted({blocks[k] for k in c}, key=order.index) for c in classes), key=lambda g: order.index(g[0]))
    # `sensor` appears once, in the first group with another block.
    for group in [group for group in groups if "sensor" in group][1:]:
        group.remove("sensor")
    return [group for group in groups if group]


def _find_overdetermined(equations: Collection[Equation]) -> set[int]:
    """Return the indices of the equations in M+, which hold more equations than unknowns."""
    rows = list(equations)
    if not rows:
        return set()
    unknowns = sorted(frozenset[str]().union(*(row.unknowns for row in rows)))
    incidence = np.array([[unknown in row.unknowns for unknown in unknowns] for row in rows], dtype=np.int8)
    columns = maximum_bipartite_matching(csr_array(incidence), perm_type="column")
    owner = {unknowns[column]: k for k, column in enumerate(columns) if column >= 0}
    reached = set(range(len(rows))) - set(owner.values())
    queue = list(reached)
    while queue:
        found = {owner[unknown] for unknown in rows[queue.pop()].unknowns if unknown in owner} - reached
        reached |= found
        queue += found
    return reached


def describe_missing_sensors(rig: str, channels: Collection[str]) -> list[str]:
    """Return a sentence for each distinction that these channels do not allow, with the channel that would allow it."""
    groups = find_isolable_groups(rig, channels)
    missing = [name for name in _RIGS[rig].remedies if not _is_recorded(name, channels)]
    sentences = [_loss(rig, channels, groups, name) for name in missing]
    sentences += [
        f"{join_names(group)} cannot be distinguished by any channel:"
        " only the form of an effect, or a repeat of a run, can"
        for group in find_isolable_groups(rig, {*channels, *missing})
        if len(group) > 1
    ]
    return [sentence for sentence in sentences if sentence]


def _equations(rig: str, channels: Collection[str]) -> list[Equation]:
    """Return the equations of a rig with these channels; a coil without any record carries a stated current."""
    equations = list(_RIGS[rig].equations)
    if _is_recorded("current_command", channels) or "coil_current" not in channels:
        equations.append(Equation(frozenset({"i"}), "coil"))  # i' = rate (command - i), the command known
    sensed = {name: frozenset({_SENSED[name]}) for name in sorted(channels) if name in _SENSED}
    return equations + [Equation(unknown, f"sensor {name}") for name, unknown in sensed.items()]


def _is_recorded(name: str, channels: Collection[str]) -> bool:
    return name in channels or (name == "current_command" and "command_voltage" in channels)


def _is_isolable(equations: list[Equation], first: int, second: int) -> bool:
    """Say whether equation `first` can still be tested after equation `second` is removed."""
    others = equations[:second] + equations[second + 1 :]
    return first - (first > second) in _find_overdetermined(others)


def _loss(rig: str, channels: Collection[str], groups: list[list[str]], absent: str) -> str:
    """Return a sentence on what the absence of one channel costs, empty where adding it alone would change nothing."""
    better = find_isolable_groups(rig, {*channels, absent})
    unseen = [block for block in itertools.chain(*better) if not any(block in group for group in groups)]
    parts = [[[b for b in group if b in new] for new in better] for group in groups]
    split = [[part for part in found if part] for found in parts]
    costs = [
        f"{join_names([_named(part) for part in found])} cannot be distinguished" for found in split if len(found) > 1
    ]
    costs += [f"{join_names(unseen)} cannot be assessed"] if unseen else []
    return f"without {absent}, {join_names(costs)}: {_RIGS[rig].remedies[absent]}" if costs else ""


def _named(part: list[str]) -> str:
    """Return the names of some blocks; `floor` is not named beside the suspension."""
    return " or ".join(block for block in part if block != "floor" or "suspension" not in part)
