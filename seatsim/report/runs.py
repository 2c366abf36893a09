"""The reports of one simulated run and of a comparison of several."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.plots.runs.naming import find_unit, select_shown
from seatsim.report.blocks import Block, Items, Report, Section, Table, Text
from seatsim.report.credibility.card import show_card
from seatsim.report.credibility.evidence import collect_runs
from seatsim.report.formatting import describe_channel, format_number, format_percent, format_quantity, format_sentence
from seatsim.report.method import describe_method
from seatsim.report.packing import Axis, Panel, make_density, pack_signals
from seatsim.report.planes import Curve, draw_curves
from seatsim.report.spectra import METHOD as SPECTRA
from seatsim.report.spectra import estimate_spectrum
from seatsim.scenario.numbers import list_numbers
from seatsim.schema.text import join_names
from seatsim.simulation.result import UNITS, Run

Array = NDArray[np.float64]

COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_peak"
TABLE = {
    COMFORT: "driver, weighted RMS", "driver_acceleration_rms": "driver, RMS", "driver_vdv": "driver, VDV",
    "seat_factor": "SEAT factor", "suspension_displacement_rms": "travel, RMS", TRAVEL: "travel, peak",
    "end_stop_hits": "end stops met", "current_rms": "current, RMS",
}  # fmt: skip
"""Metrics of the table of several runs, and their headings; `summary.csv` has all of them."""
CHANNELS = (
    "driver_acceleration", "suspension_displacement", "damper_force", "coil_current", "frame_acceleration",
    "floor_acceleration", "damper_temperature",
)  # fmt: skip
HIGHEST = 50.0
"""Hz up to which spectra are drawn: more than a seat passes on."""
LOOP_SECONDS = 6.0
"""Seconds of the loops: more of them hide each other."""
METHOD = (
    "Accelerations are of the whole run after the settling time that the scenario states; 'weighted' is by Wk of ISO"
    " 2631-1; the SEAT factor is the driver's weighted acceleration over the floor's.",
    SPECTRA,
)


def report_runs(runs: Sequence[Run], command: str, title: str) -> Report:
    """Return the report of runs: of a single one, or of a comparison.

    Args:
        runs: the runs, at least one.
        command: what makes the report again.
        title: of the folder that they share.
    """
    shown = select_shown(runs)
    names = name_runs(shown)
    lines = list(zip(names, _choose_looks(len(shown)), strict=True))
    omitted = f" {len(shown)} of {len(runs)} runs are drawn." if len(shown) < len(runs) else ""
    sections = [
        Section("figures", "Comfort, travel and effort", [_make_table(runs)]),
        Section("signals", "Signals over time", [show_signals(shown, lines, omitted)]),
        Section("spectra", "Driver and floor over frequency", _show_spectra(shown, lines)),
        Section("loops", "Damper force over velocity", [_draw_loops(shown, lines)]),
        Section("notes", "Notes", _list_notes(runs)),
        show_card(collect_runs(runs)),
        describe_method(METHOD, _list_settings(runs[0]), command),
    ]
    single = len(runs) == 1
    about = f"Simulated run: {title}" if single else f"Comparison of {len(runs)} simulated runs: {title}"
    answer = describe_run(runs[0]) if single else _compare(runs)
    return Report(about, answer, [], _advise(runs), sections)


def name_runs(runs: Sequence[Run]) -> list[str]:
    """Return what sets runs apart, numbered where two are alike."""
    titles = [run.scenario.title for run in runs]
    return [f"{title} ({k + 1})" if titles.count(title) > 1 else title for k, title in enumerate(titles)]


def describe_run(run: Run) -> str:
    """Return in a sentence what a run comes to: comfort, and the travel that it takes."""
    comfort, seat = read_metric(run, COMFORT), read_metric(run, "seat_factor")
    said = f"{run.scenario.title}: the driver feels {format_quantity(comfort, 'm/s^2')} (weighted RMS)"
    if np.isfinite(seat):
        change = "less" if seat < 1 else "more"
        said += f", {format_percent(abs(1 - seat))} {change} than the floor moves"
    said += f"; the suspension travels up to {format_quantity(read_metric(run, TRAVEL), 'm')} from its rest"
    hits = read_metric(run, "end_stop_hits")
    if np.isfinite(hits):
        said += " and never meets its end stops" if hits == 0 else f" and meets its end stops {hits:.0f} times"
    return f"{said}."


def read_metric(run: Run, name: str) -> float:
    """Return a metric of a run in SI units, NaN where it has none."""
    return run.metrics[name].value if name in run.metrics else float("nan")


def show_signals(runs: Sequence[Run], lines: Sequence[tuple[str, int]], note: str = "") -> Block:
    """Return linked pictures of the channels that some run has, a line for each run."""
    longest = max(runs, key=lambda run: len(run["time"]))
    time = np.asarray(longest["time"])
    panels = [
        Panel(channel, UNITS[channel], "", {"": [_read_channel(run, channel, len(time)) for run in runs]})
        for channel in CHANNELS
        if any(_read_channel(run, channel, len(time)) is not None for run in runs)
    ]
    return pack_signals("signals-time", f"All runs over time.{note}", lines, Axis("time", "s", {"": time}), panels)


def _read_channel(run: Run, channel: str, length: int) -> Array | None:
    """Return a channel, filled up with NaN to a length; None where it has none."""
    if channel not in run.history.channels:
        return None
    values = np.asarray(run[channel], dtype=float)
    if not np.isfinite(values).any():
        return None
    return np.pad(values, (0, length - len(values)), constant_values=np.nan)


def _show_spectra(runs: Sequence[Run], lines: Sequence[tuple[str, int]]) -> list[Block]:
    time = [np.asarray(run["time"]) for run in runs]
    drivers, floors = (
        [estimate_spectrum(t, np.asarray(run[channel]), HIGHEST) for t, run in zip(time, runs, strict=True)]
        for channel in ("driver_acceleration", "floor_acceleration")
    )
    known = [found[0] for found in drivers if found is not None]
    if not known:
        return [Text("The runs are too short for a spectrum.")]
    frequency = min(known, key=len)
    values, floor = (
        [None if each is None or not each[1].any() else each[1][: len(frequency)] for each in found]
        for found in (drivers, floors)
    )
    axis = Axis("frequency", "Hz", {"": frequency}, logarithmic=True)
    panels = [make_density("driver acceleration", "m/s^2", {"": values})]
    if any(each is not None for each in floor):
        panels.append(make_density("floor acceleration", "m/s^2", {"": floor}))
    return [pack_signals("signals-frequency", "All runs over frequency.", lines, axis, panels, logarithmic=True)]


def _draw_loops(runs: Sequence[Run], lines: Sequence[tuple[str, int]]) -> Block:
    curves = []
    for run, (name, look) in zip(runs, lines, strict=True):
        time = np.asarray(run["time"])
        part = time >= time[-1] - LOOP_SECONDS
        every = max(1, int(part.sum()) // 1500)
        velocity, force = np.asarray(run["suspension_velocity"])[part], np.asarray(run["damper_force"])[part]
        curves.append(Curve(name, velocity[::every], force[::every], look, "dots"))
    caption = f"Samples of the last {LOOP_SECONDS:g} s; positive force opposes extension."
    return draw_curves("Damper force over velocity", caption, ("suspension velocity [m/s]", "damper force [N]"), curves)


def _make_table(runs: Sequence[Run]) -> Table:
    if len(runs) == 1:
        return list_metrics(runs[0])
    chosen = [name for name in TABLE if any(name in run.metrics for run in runs)]
    shown = {name: describe_channel(TABLE[name], _unit_of(runs, name)) for name in chosen}
    head = ["run", *(each.words if each.unit == "-" else each.axis for each in shown.values())]
    rows = [
        [
            f"{name} (unverified)" if run.unverified else name,
            *(format_number(shown[metric].factor * read_metric(run, metric)) for metric in chosen),
        ]
        for name, run in zip(name_runs(runs), runs, strict=True)
    ]
    best = _rank(runs)[:1]
    bold = " The most comfortable run is in bold." if best else ""
    return Table(f"Figures of each run; summary.csv has more.{bold}", head, rows, 1, best)


def list_metrics(run: Run) -> Table:
    """Return every figure of a run as a table."""
    rows = [
        [format_sentence(metric.meaning).rstrip("."), format_quantity(metric.value, metric.unit)]
        for metric in run.metrics.values()
    ]
    return Table("Every figure of the run", ["figure", "value"], rows)


def _unit_of(runs: Sequence[Run], name: str) -> str:
    return next(run.metrics[name].unit for run in runs if name in run.metrics)


def _rank(runs: Sequence[Run]) -> list[int]:
    """Return the runs with a weighted acceleration that can be relied on, the most comfortable first."""
    known = [k for k, run in enumerate(runs) if np.isfinite(read_metric(run, COMFORT)) and not run.unverified]
    return sorted(known, key=lambda k: read_metric(runs[k], COMFORT))


def _compare(runs: Sequence[Run]) -> str:
    order = _rank(runs)
    if len(order) < 2:
        return f"{len(runs)} runs were simulated; too few of them have figures that can be relied on to be compared."
    best, worst = runs[order[0]], runs[order[-1]]
    low, high = read_metric(best, COMFORT), read_metric(worst, COMFORT)
    if high <= 1.005 * low:
        return f"All {len(order)} runs are alike in comfort: {format_quantity(low, 'm/s^2')} (weighted RMS)."
    return (
        f"Of {len(order)} runs {best.scenario.title} is the most comfortable: the driver feels"
        f" {format_quantity(low, 'm/s^2')} (weighted RMS), {format_percent(1 - low / high)} less than with"
        f" {worst.scenario.title}; it travels up to {format_quantity(read_metric(best, TRAVEL), 'm')}."
    )


def _advise(runs: Sequence[Run]) -> list[str]:
    found = []
    hitting = [name for name, run in zip(name_runs(runs), runs, strict=True) if read_metric(run, "end_stop_hits") > 0]
    doubtful = [name for name, run in zip(name_runs(runs), runs, strict=True) if run.unverified]
    if doubtful:
        found.append(f"Do not rely on {join_names(doubtful[:3])}: the notes say why the figures are unverified.")
    if hitting:
        found.append(f"Look at the travel of {join_names(hitting[:3])}: end stops are met, which is felt as a jolt.")
    amplifies = [name for name, run in zip(name_runs(runs), runs, strict=True) if read_metric(run, "seat_factor") > 1]
    if amplifies:
        found.append(f"The driver feels more than the floor moves in {join_names(amplifies[:3])}: more damping near the"
                     " seat's resonance, or a law such as skyhook, lowers it.")  # fmt: skip
    if len(runs) == 1:
        found.append("Compare it with other laws or settings: seatsim compare takes several scenarios or a sweep.")
    else:
        found.append("Ask whether the order holds on other roads and drivers: seatsim sweep varies both.")
    return found


def _list_notes(runs: Sequence[Run]) -> list[Block]:
    texts = [f"{run.scenario.title} is unverified: {reason}" for run in runs for reason in run.unverified]
    texts += [sentence for run in runs for sentence in run.warnings]
    texts += [f"{run.scenario.title}: {sentence}" for run in runs for sentence in run.history.notes]
    return [Items([format_sentence(text) for text in dict.fromkeys(texts)])] if texts else []


def _list_settings(run: Run) -> dict[str, object]:
    """Return the numbers of a scenario by dotted key, with their units."""
    found: dict[str, object] = {}
    for key, value in list_numbers(run.scenario).items():
        unit = find_unit(run.scenario, key)
        found[f"{key} [{unit}]" if unit else key] = value
    return found


def _choose_looks(count: int) -> list[int]:
    return [2] if count == 1 else [k % 8 for k in range(count)]
