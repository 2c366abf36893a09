"""Simulated runs over time, a line for each, to be zoomed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.plots.runs.naming import Shown
from seatsim.report.blocks import Signals
from seatsim.report.packing import Panel, pack_signals
from seatsim.schema.arrays import Array
from seatsim.simulation.result import UNITS

CHANNELS = (
    "driver_acceleration", "suspension_displacement", "damper_force", "coil_current", "frame_acceleration",
    "floor_acceleration", "damper_temperature",
)  # fmt: skip


def show_signals(groups: Sequence[Shown]) -> Signals:
    """Return linked pictures of the channels that some run has; of several scenarios the reader chooses one."""
    names = list(dict.fromkeys(look.label for shown in groups for look in shown.looks))
    time = {shown.scenario: max((np.asarray(run["time"]) for run in shown.runs), key=len) for shown in groups}
    panels = []
    for channel in CHANNELS:
        values = {shown.scenario: _read(shown, channel, names, len(time[shown.scenario])) for shown in groups}
        known = [[each for each in part if each is not None] for part in values.values()]
        if any(known):
            panels.append(Panel(channel, UNITS[channel], _note_equal(known), values))
    caption = "The list above the pictures has every scenario." if len(groups) > 1 else "All runs over time."
    omitted = next((shown.omission for shown in groups if shown.omission), "")
    return pack_signals(f"{caption}{omitted}", [(name, k % 8) for k, name in enumerate(names)], time, panels)


def _note_equal(groups: Sequence[Sequence[Array]]) -> str:
    """Return a sentence where the lines of several runs lie on each other, which a picture does not show."""
    several = [group for group in groups if len(group) > 1]
    same = all(np.array_equal(group[0], each, equal_nan=True) for group in several for each in group[1:])
    return "The same in all runs." if several and same else ""


def _read(shown: Shown, channel: str, names: Sequence[str], length: int) -> list[Array | None]:
    """Return a channel of each named run, filled up with NaN to a length; None where there is none."""
    runs = {look.label: run for look, run in zip(shown.looks, shown.runs, strict=True)}
    found: list[Array | None] = []
    for run in map(runs.get, names):
        values = np.asarray(run[channel]) if run is not None and channel in run.history.channels else np.full(1, np.nan)
        known = np.isfinite(values).any()
        found.append(np.pad(values, (0, length - len(values)), constant_values=np.nan) if known else None)
    return found
