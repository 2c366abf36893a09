"""Pictures of simulated runs: signals over time, spectra, and loops of the damper, a line for each run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from seatsim.plots.runs.naming import label_runs, select_shown
from seatsim.report.blocks import Block, Text
from seatsim.report.packing import Axis, Panel, make_density, pack_signals
from seatsim.report.planes import Curve, draw_curves, join_planes
from seatsim.report.spectra import estimate_spectrum
from seatsim.schema.arrays import Array
from seatsim.simulation.result import UNITS, Run

Groups = Mapping[str, Mapping[str, Run]]
"""Runs that are drawn over each other, by name, in groups of which the reader chooses one; alone it has no name."""

CHANNELS = (
    "driver_acceleration", "suspension_displacement", "damper_force", "coil_current", "frame_acceleration",
    "floor_acceleration", "damper_temperature",
)  # fmt: skip
HIGHEST = 50.0
"""Hz up to which spectra are drawn: more than a seat passes on."""
LOOP_SECONDS = 6.0
"""Seconds of the loops: more of them hide each other."""
DOTS = 1500
"""Samples of a run in all its loops."""


def name_runs(runs: Sequence[Run]) -> list[str]:
    """Return what sets runs apart, numbered where two are alike; the name of a scenario only beside others."""
    is_one = len(runs) > 1 and len({run.scenario.name for run in runs}) == 1
    titles = label_runs(runs) if is_one else [run.scenario.title for run in runs]
    return [f"{title} ({k + 1})" if titles.count(title) > 1 else title for k, title in enumerate(titles)]


def group_runs(runs: Sequence[Run]) -> Groups:
    """Return the runs that are drawn: one group, or one for each scenario where some of several have several runs."""
    scenarios = list(dict.fromkeys(run.scenario.name for run in runs))
    if 1 < len(scenarios) < len(runs):
        parts = {name: [run for run in runs if run.scenario.name == name] for name in scenarios}
    else:
        parts = {"": list(runs)}
    shown = {name: select_shown(part) for name, part in parts.items()}
    return {name: dict(zip(name_runs(part), part, strict=True)) for name, part in shown.items()}


def list_lines(groups: Groups) -> list[tuple[str, int]]:
    """Return the names of the runs of all groups, each with the look in which it is drawn."""
    names = list(dict.fromkeys(name for group in groups.values() for name in group))
    return [(names[0], 2)] if len(names) == 1 else [(name, k % 8) for k, name in enumerate(names)]


def show_signals(groups: Groups, note: str = "") -> Block:
    """Return linked pictures of the channels that some run has, a line for each run of a group."""
    lines = list_lines(groups)
    time = {name: max((np.asarray(run["time"]) for run in group.values()), key=len) for name, group in groups.items()}
    panels = []
    for channel in CHANNELS:
        values = {
            name: [_read_channel(group.get(line), channel, len(time[name])) for line, _ in lines]
            for name, group in groups.items()
        }
        known = [[each for each in part if each is not None] for part in values.values()]
        if any(known):
            panels.append(Panel(channel, UNITS[channel], _note_equal(known), values))
    caption = "The list above the pictures has every scenario." if len(groups) > 1 else "All runs over time."
    return pack_signals("signals-time", f"{caption}{note}", lines, Axis("time", "s", time), panels)


def _note_equal(groups: Sequence[Sequence[Array]]) -> str:
    """Return a sentence where the lines of several runs lie on each other, which a picture does not show."""
    several = [group for group in groups if len(group) > 1]
    same = all(np.array_equal(group[0], each, equal_nan=True) for group in several for each in group[1:])
    return "The same in all runs." if several and same else ""


def _read_channel(run: Run | None, channel: str, length: int) -> Array | None:
    """Return a channel, filled up with NaN to a length; None where it has none."""
    if run is None or channel not in run.history.channels:
        return None
    values = np.asarray(run[channel], dtype=float)
    if not np.isfinite(values).any():
        return None
    return np.pad(values, (0, length - len(values)), constant_values=np.nan)


def show_spectra(groups: Groups) -> list[Block]:
    """Return linked pictures of the spectra of driver and floor."""
    lines, frequency = list_lines(groups), dict[str, Array]()
    values: dict[str, dict[str, list[Array | None]]] = {"driver_acceleration": {}, "floor_acceleration": {}}
    for name, group in groups.items():
        for channel, found in values.items():
            spectra = [_estimate_spectrum(group.get(line), channel) for line, _ in lines]
            known = [each[0] for each in spectra if each is not None]
            if not known:
                return [Text("The runs are too short for a spectrum.")]
            frequency[name] = min([*known, *([frequency[name]] if name in frequency else [])], key=len)
            found[name] = [None if each is None or not each[1].any() else each[1] for each in spectra]
    panels = [
        make_density(channel.replace("_", " "), "m/s^2", {
            name: [None if line is None else line[: len(frequency[name])] for line in part]
            for name, part in found.items()
        })
        for channel, found in values.items()
        if any(line is not None for part in found.values() for line in part)
    ]  # fmt: skip
    axis = Axis("frequency", "Hz", frequency, logarithmic=True)
    caption = "Power spectral densities; a floor at rest has none."
    return [pack_signals("signals-frequency", caption, lines, axis, panels, logarithmic=True)]


def _estimate_spectrum(run: Run | None, channel: str) -> tuple[Array, Array] | None:
    """Return the spectrum of a channel; None without a run, or where it is too short."""
    return None if run is None else estimate_spectrum(np.asarray(run["time"]), np.asarray(run[channel]), HIGHEST)


def draw_loops(groups: Groups) -> Block:
    """Return one figure of the damper force over velocity, with a plane for each group."""
    looks = dict(list_lines(groups))
    axes = ("suspension velocity [m/s]", "damper force [N]")
    planes = []
    for title, group in groups.items():
        curves = []
        for name, run in group.items():
            time = np.asarray(run["time"])
            part = time >= time[-1] - LOOP_SECONDS
            every = max(1, int(part.sum()) // (DOTS // len(groups)))
            velocity, force = np.asarray(run["suspension_velocity"])[part], np.asarray(run["damper_force"])[part]
            curves.append(Curve(name, velocity[::every], force[::every], looks[name], "dots"))
        planes.append(draw_curves(title, "", axes, curves))
    caption = f"Samples of the last {LOOP_SECONDS:g} s; positive force opposes extension."
    return join_planes("Damper force over velocity", caption, planes)
