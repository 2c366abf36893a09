"""The report of a gap: how far a scenario is from a recording, channel by channel and run by run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from seatsim.metrics.motion import rms
from seatsim.recordings.gap import Gap, ReplayedPair
from seatsim.report.blocks import Block, Items, Matrix, Report, Section, Signals, Table, Text
from seatsim.report.credibility.card import show_card
from seatsim.report.credibility.evidence import Evidence
from seatsim.report.formatting import format_noise, format_percent, format_sentence, say_noise
from seatsim.report.method import describe_method
from seatsim.report.packing import Axis, Panel, make_density, pack_signals
from seatsim.report.spectra import METHOD as SPECTRA
from seatsim.report.spectra import estimate_spectrum
from seatsim.schema.arrays import Array

NEAR_NOISE = 1.2
"""Gap over its noise up to which nothing is left to explain."""
METHOD = (
    "Every run is replayed with its recorded inputs; row k of every channel is the same instant; the first second of"
    " each run is left out.",
    "The gap of a channel is the RMS of measured less simulated over the standard deviation of the measured signal,"
    " over all samples of all runs; overall is the root of the mean square over the channels.",
    "The noise floor is the gap that the stated noise of the sensor alone would make.",
    SPECTRA,
)


def report_gap(name: str, found: Gap, pairs: Mapping[str, ReplayedPair], evidence: Evidence, command: str) -> Report:
    """Return the report of a gap.

    Args:
        name: of scenario and recording, for the head.
        found: the gap.
        pairs: measured and simulated channels of every run.
        evidence: for the credibility of the figures.
        command: what makes the report again.
    """
    channels = list(found.channels)
    sections = [
        Section("gaps", "How far: gap of each channel", [_make_table(found), *_make_matrix(channels, pairs)]),
        Section("signals", "Measured and simulated over time", [_show_pairs(channels, pairs)]),
        Section("spectra", "Spectrum of the difference", _show_left(channels, pairs)),
        Section("notes", "Notes on the data", _list_notes(found)),
        show_card(evidence),
        describe_method(METHOD, command),
    ]
    return Report(f"Gap: {name}", say_gap(found), [], _advise(found), sections)


def say_gap(found: Gap) -> str:
    """Return in a sentence how far a simulation is from its recording."""
    floor = found.floor.overall
    worst = max(found.channels, key=lambda name: found.channels[name])
    size = f"The simulation is off by {format_percent(found.overall)} of the recorded signals' spread"
    if found.overall <= NEAR_NOISE * floor:
        return f"{size}; {say_noise(floor)}: there is nothing left to explain."
    return (
        f"{size}; {say_noise(floor)}. It is furthest off in the"
        f" {worst.replace('_', ' ')}, by {format_percent(found.channels[worst])}."
    )


def _advise(found: Gap) -> list[str]:
    if found.overall <= NEAR_NOISE * found.floor.overall:
        return ["Use the scenario as it is; test it on a recording of another road or driver."]
    return ["Find the cause with seatsim diagnose: it names the effect, and says how far the gap shrinks with it."]


def _show_pairs(channels: Sequence[str], pairs: Mapping[str, ReplayedPair]) -> Signals:
    """Return linked pictures of the measured and the simulated channels of every run."""
    axes = {run: pair.time for run, pair in pairs.items()}
    panels = [
        Panel(name, next(iter(pairs.values())).units[name], "",
              {run: [pair.measured.get(name), pair.simulated.get(name)] for run, pair in pairs.items()})
        for name in channels
    ]  # fmt: skip
    lines = [("measured", 0), ("simulated", 1)]
    caption = "Every run is in the list above the pictures."
    return pack_signals("signals-time", caption, lines, Axis("time", "s", axes), panels)


def _make_table(found: Gap) -> Table:
    rows = [["overall", format_percent(found.overall), format_noise(found.floor.overall)]]
    rows += [
        [name.replace("_", " "), format_percent(value), format_noise(found.floor.channels[name])]
        for name, value in found.channels.items()
    ]
    caption = "Gap over all runs, in per cent of the standard deviation of the measured signal"
    return Table(caption, ["channel", "gap", "noise floor"], rows, 1, [0])


def _make_matrix(channels: Sequence[str], pairs: Mapping[str, ReplayedPair]) -> list[Block]:
    if len(pairs) < 2:
        return []
    rows = []
    for name in channels:
        gaps = [
            rms(pair.measured[name] - pair.simulated[name]) / spread
            if name in pair.measured and (spread := float(np.std(pair.measured[name]))) > 0
            else np.nan
            for pair in pairs.values()
        ]
        cells = [(format_percent(gap), shade_share(gap)) if np.isfinite(gap) else ("", 0) for gap in gaps]
        rows.append((name.replace("_", " "), cells))
    caption = "In per cent of the standard deviation of the signal in the run; the darker, the larger."
    return [Matrix("Gap of each run", caption, "channel", list(pairs), rows)]


def shade_share(share: float) -> int:
    """Return the shade, 0 to 9, of a share of 1."""
    return min(9, max(0, int(10 * share)))


def _show_left(channels: Sequence[str], pairs: Mapping[str, ReplayedPair]) -> list[Block]:
    axes: dict[str, Array] = {}
    values: dict[str, dict[str, list[Array | None]]] = {name: {} for name in channels}
    for run, pair in pairs.items():
        for name in channels:
            signals = (pair.measured[name], pair.measured[name] - pair.simulated[name])
            found = [spectrum for signal in signals if (spectrum := estimate_spectrum(pair.time, signal))]
            if not found:
                return [Text("The runs are too short for a spectrum.")]
            axes[run] = found[0][0]
            values[name][run] = [power for _, power in found]
    units = next(iter(pairs.values())).units
    panels = [make_density(name, units[name], values[name]) for name in channels]
    lines = [("measured", 0), ("measured less simulated", 1)]
    axis = Axis("frequency", "Hz", axes, logarithmic=True)
    caption = "Spectra of the measured signal and of what the simulation does not reproduce."
    return [pack_signals("signals-frequency", caption, lines, axis, panels, logarithmic=True)]


def _list_notes(found: Gap) -> list[Block]:
    return [Items([format_sentence(note) for note in found.notes])] if found.notes else []
