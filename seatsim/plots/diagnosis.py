"""Figures of a diagnosis and of a gap.

The answer in three pictures: the gaps, the blocks they lie in, the effects that may cause them. The evidence: maps of
the error over motion and current, the signal that the simulation lacks, each compared channel over time and frequency,
which shows a gap, with one simulation, and a diagnosis, with two.
"""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Literal, TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from seatsim.diagnosis import residuals
from seatsim.diagnosis.result import Diagnosis, Gaps, RunGaps, Trace
from seatsim.metrics.motion import rms
from seatsim.metrics.spectra import estimate_density
from seatsim.plots import style
from seatsim.plots.densities import draw_densities, find_first, state_method
from seatsim.plots.style import COLOURS, DASHES, MEASURED, Entry, Grid, draw_bars, make_rows
from seatsim.plots.thinning import Window, find_loudest, thin_line
from seatsim.recordings.gap import Gap, GapFigures
from seatsim.schema.arrays import Array
from seatsim.schema.printing import describe_channel, format_number
from seatsim.schema.text import join_names

MOST = 10
"""Causes that are shown."""
LIKELY = 0.01
"""Probability from which on an effect has a row of its own."""
_CHOSEN, _EQUIVALENT, OTHER, REST = COLOURS[0], COLOURS[4], "0.72", "0.45"
"""Colours of selected effects, of effects that explain the gap equally well, of others, of no or an unknown cause."""
SMALLEST = 1e-4
"""Gap below which none is drawn: a logarithmic scale has no zero."""
Key = Literal["floor", "before", "calibrated", "after"]
STAGES: dict[Key, Entry] = {
    "floor": Entry("noise floor", "black", "none", mark="|", hollow=True),
    "before": Entry("nominal", COLOURS[1], "none", mark="o"),
    "calibrated": Entry("refitted", COLOURS[2], "none", mark="D", hollow=True),
    "after": Entry("with effects", COLOURS[0], "none", mark="s"),
}
"""How each gap of a diagnosis is called and marked."""
_SIZES = {"|": 13, "o": 8, "D": 10, "s": 5}
"""Sizes of the marks in points: of marks at one place, each is seen."""
BINS = (22, 13)
"""Bins of a map over velocity and over the other quantity."""
DOTS = 2500
UNITS = {"velocity": "m/s", "displacement": "m", "coil_current": "A", "damper_temperature": "degC"}
MOTIONS = {name: describe_channel(name, unit) for name, unit in UNITS.items()}
"""How measured motion, of a suspension or a damper, is shown."""
SECONDS, RASTER = 2.0, 0.05
"""Length in s of the window that is shown, and the raster on which it begins."""
_SHADED = 2.0
"""Standard deviations of the noise that are shaded."""
DECADES = 9.0
"""Decades below the highest density that a spectrum shows: down to the noise of a good sensor."""
NOMINAL = Entry("nominal", COLOURS[1], DASHES[1], width=1.3)
NOISE = Entry("sensor noise", "black", ":", width=1.3)
_BAND = Entry(f"±{_SHADED:g} RMS of the noise", style.AREA, width=8)
GRID = Grid((1.5, 1.0, 1.3), left=1.04, gap=(0.0, 0.5))
_Looks: TypeAlias = dict[str, Entry]
"""Looks of simulations that are compared with a measurement, by their names in a trace."""
LETTERS = 19
"""Letters of a label beside a panel that is this low."""


def plot_diagnosis(diagnosis: Diagnosis) -> dict[str, Figure]:
    """Return the figures of a diagnosis by name; without a gap there is no evidence for causes to be drawn.

    After the others a picture of each held-out channel, the channel with the largest nominal gap first.
    """
    plots = {"gaps": _plot_gaps}
    if diagnosis.verdict != "none":
        plots |= {"location": _plot_location, "ranking": _plot_ranking}
        plots |= {"discrepancy": _plot_discrepancy, "maps": _plot_maps}
    last = find_last(diagnosis)
    looks = {"nominal": NOMINAL, "after": Entry(last.label, last.colour, width=1.1)}
    found = {name: figure for name, plot in plots.items() if (figure := plot(diagnosis)) is not None}
    return found | _plot_channels(diagnosis.evidence.traces, looks)


def plot_all_of_gap(found: Gap) -> dict[str, Figure]:
    """Return the figures of a gap by name: of all channels, then of each, the one with the largest gap first."""
    looks = {"nominal": NOMINAL._replace(label="simulated")}
    return {"gap": _plot_gap(found), **_plot_channels(residuals.list_traces(found), looks)}


def select_stages(diagnosis: Diagnosis) -> list[Key]:
    """Return the gaps that are shown, in the order of the diagnosis; without effects `after` is that of the refit."""
    after: list[Key] = ["after"] if diagnosis.selected else []
    return ["before", "calibrated", *after, "floor"]


def find_last(diagnosis: Diagnosis) -> Entry:
    """Return what the simulation of `augmented.yaml` is called, and its mark; without effects it is the refitted."""
    return STAGES["after" if diagnosis.selected else "calibrated"]


def read_gap(gaps: Gaps | RunGaps, key: Key, channel: str) -> float | None:
    """Return the gap of a channel, or of all ("overall"), over the signal's standard deviation; None if unknown."""
    figures: GapFigures = getattr(gaps, key)
    return (figures.channels | {"overall": figures.overall}).get(channel)


def _plot_gaps(diagnosis: Diagnosis) -> Figure | None:
    """Return the gap of each channel on its way from the nominal simulation to the noise floor."""
    names, keys = ["overall", *diagnosis.gap.before.channels], select_stages(diagnosis)
    rows = [[read_gap(diagnosis.gap, key, name) or 0.0 for key in keys] for name in names]
    title, stages = "Gap of each channel, before and after", [STAGES[key] for key in keys]
    return _draw_gaps(title, names, stages, rows, " of held-out runs") if names[1:] else None


def _plot_gap(found: Gap) -> Figure:
    """Return the gap of each channel beside its noise floor."""
    floor = [found.floor.overall, *(found.floor.channels[name] for name in found.channels)]
    rows = list(zip([found.overall, *found.channels.values()], floor, strict=True))
    stages = [STAGES["before"]._replace(label="gap"), STAGES["floor"]]
    return _draw_gaps("Gap of each channel", ["overall", *found.channels], stages, rows)


def _draw_gaps(
    title: str, names: Sequence[str], stages: Sequence[Entry], rows: Sequence[Sequence[float]], where: str = ""
) -> Figure:
    """Return a figure with the gaps of each name, one for each stage."""
    known = [100 * value for row in rows for value in row if np.isfinite(value) and value > SMALLEST]
    # A noise floor that nobody stated has no mark, and none in the legend.
    columns = zip(stages, zip(*rows, strict=True), strict=True)
    legend = [stage for stage, values in columns if max(np.nan_to_num(values)) > 0]
    shown = [name.replace("_", " ") for name in names]
    note = f"RMS of measured less simulated over the spread of the signal{where}; further left is better."
    figure, [axes] = make_rows(title, note, shown, legend, [0])
    style.scale_log(axes, "x", min(known, default=1.0) / 1.4, max(known, default=1.0) * 1.4)
    for row, values in enumerate(rows):
        seen = [(stage, 100 * value) for stage, value in zip(stages, values, strict=True) if value > SMALLEST]
        if seen:
            axes.plot([min(v for _, v in seen), max(v for _, v in seen)], [row, row], color="0.8", linewidth=1.5)
        for stage, value in seen:
            style.draw_line(axes, [value], [row], stage).set(markersize=_SIZES[stage.mark], zorder=3)
    if not known:
        axes.text(0.5, 0.5, f"every gap is below {100 * SMALLEST:g} %", transform=axes.transAxes, ha="center")
    axes.axhline(0.5, color="0.8", linewidth=0.8)
    axes.set_xlabel("gap [%]")
    return figure


def _plot_location(diagnosis: Diagnosis) -> Figure | None:
    """Return the shares of the gap that lie in the blocks."""
    shares = diagnosis.where
    if not shares:
        return None
    alike = {name.partition(".")[0] for name in _find_equivalent(diagnosis)}
    merged = [share.block for share in shares if share.block in alike]
    first, note = shares[0], "The shares add up to 100 %."
    title = f"{_format_percent(100 * first.share)} of the gap lies in the {first.block}"
    if diagnosis.verdict == "unknown":
        title = f"What stays unexplained lies in the {first.block}"
    elif first.block in alike and len(merged) > 1:
        title = f"The gap lies in the {' or the '.join(merged)}"
        note += " Light blue: cannot be told from the first on this recording."
    figure, [axes] = make_rows(title, note, [share.block for share in shares], [], [])
    values = [100 * share.share for share in shares]
    colours = [_CHOSEN, *(_EQUIVALENT if share.block in alike else OTHER for share in shares[1:])]
    draw_bars(axes, values, colours, list(map(_format_percent, values)))
    axes.set(xlim=(0, 100), xticks=[0, 50, 100], xlabel="share of the gap [%]")
    return figure


def _plot_ranking(diagnosis: Diagnosis) -> Figure | None:
    """Return how probable the first causes are, and what each alone takes off the gap; equal rows are one."""
    if not diagnosis.causes:
        return None
    names, probabilities, shrinks, colours, texts = map(list, zip(*_list_rows(diagnosis), strict=True))
    alike = [name for name, colour in zip(names, colours, strict=True) if colour in (_CHOSEN, _EQUIVALENT)]
    found = join_names(alike, "or" if _EQUIVALENT in colours else "and") if diagnosis.selected else "none is named"
    title = f"Effects at work: {found}"
    equivalent = " Light blue: explain the gap as well." if _EQUIVALENT in colours else ""
    note = (
        f"Bold and blue: the answer of the diagnosis.{equivalent} Left: how probable it is that an effect is at work;"
        " two effects can both be near 100 %."
    )
    strong = [k for k, colour in enumerate(colours) if colour == _CHOSEN]
    grid = Grid((), 2, right=0.45, bottom=0.7, gap=(0.7, 0.0))
    figure, [left, right] = make_rows(title, note, names, [], strong, grid)
    for axes in (left, right):
        axes.axhline(len(names) - 2.5, color="0.8", linewidth=0.8)
    draw_bars(left, probabilities, colours, texts)
    left.set(xlim=(0, 100), xticks=[0, 50, 100], xlabel="probability [%]")
    draw_bars(right, shrinks, colours, [_format_percent(each) if np.isfinite(each) else "" for each in shrinks])
    known = np.nan_to_num(shrinks)
    right.set(xlim=(min(0.0, *known) * 1.5, 100), xlabel="refitted gap that the\neffect alone removes [%]")
    return figure


def _list_rows(diagnosis: Diagnosis) -> list[tuple[str, float, float, str, str]]:
    """Return of each row its name, probability and shrink in per cent, the colour, and the text of the probability."""
    looks = dict.fromkeys(_find_equivalent(diagnosis), _EQUIVALENT) | dict.fromkeys(diagnosis.selected, _CHOSEN)
    likely = [each for each in diagnosis.causes if each.effect in diagnosis.selected or each.probability >= LIKELY]
    shown = likely[:MOST]
    rows = [(each.effect, each.probability, each.shrink, looks.get(each.effect, OTHER), "") for each in shown]
    if rest := [each.probability for each in diagnosis.causes if each not in shown]:
        most = f"at most {_format_percent(100 * max(rest))}" if max(rest) >= LIKELY else f"below {100 * LIKELY:g} %"
        rows.append((f"{len(rest)} other effect{'s' * (len(rest) > 1)}", max(rest), np.nan, OTHER, most))
    ends = {"no effect at all": diagnosis.probability_none, "another cause": diagnosis.probability_unknown}
    answer = "" if diagnosis.selected else max(ends, key=lambda name: ends[name])
    rows += [(name, value, np.nan, _CHOSEN if name == answer else REST, "") for name, value in ends.items()]
    return [(name, 100 * p, 100 * cut, look, text or _format_percent(100 * p)) for name, p, cut, look, text in rows]


def _find_equivalent(diagnosis: Diagnosis) -> list[str]:
    """Return the effects in a group with a selected one, which this recording cannot tell from it."""
    groups = [group for group in diagnosis.indistinguishable if set(group) & set(diagnosis.selected)]
    return [name for group in groups for name in group]


def _format_percent(value: float) -> str:
    return "< 1 %" if 0 < value < 0.95 else f"{value:.0f} %"


def _plot_maps(diagnosis: Diagnosis) -> Figure | None:
    """Return maps of what is left of the worst channel over velocity and current (or travel), before and after."""
    found = residuals.find_worst(diagnosis)
    if found is None:
        return None
    trace, motion = found
    other = next((name for name in ("coil_current", "displacement") if residuals.varies(motion.get(name))), "")
    if not other or not residuals.varies(motion.get("velocity")):
        return None
    x, y = (MOTIONS[name].factor * motion[name] for name in ("velocity", other))
    borders = residuals.bin_edges(x, BINS[0]), residuals.bin_edges(y, BINS[1])
    shown = describe_channel(trace.channel, trace.unit)
    left = (trace.measured - trace.nominal, trace.measured - trace.after)
    cells = [shown.factor * residuals.map_rms(x, y, signal, borders) for signal in left]
    known = np.concatenate([each[np.isfinite(each)] for each in cells])
    if not known.size or not known.max() > 0:
        return None
    title = f"Error of the {shown.words} over velocity and {MOTIONS[other].words}"
    note = f"RMS of measured less simulated on {trace.run}; cells of fewer than {residuals.FEWEST} samples stay empty."
    low, high = max(float(known.min()), float(known.max()) / 100), float(known.max())
    note += f" The darkest cells: {format_number(low)} {shown.unit} or less." if known.min() < low else ""
    figure, [panels] = style.make_page(title, note, Grid((2.2,), 2, right=0.95, top=0.3, gap=(0.15, 0.0)))
    norm = LogNorm(low, high)
    for axes, name, values in zip(panels, ("nominal", find_last(diagnosis).label), cells, strict=True):
        mesh = axes.pcolormesh(*borders, values, norm=norm, cmap=colormaps["viridis"], rasterized=True)
        axes.set_xlabel(MOTIONS["velocity"].axis)
        style.set_title(axes, name)
    panels[0].set_ylabel(MOTIONS[other].axis)
    panels[1].tick_params(labelleft=False)
    style.scale_log(style.add_colour_bar(panels[1], mesh, f"error [{shown.unit}], logarithmic"), "y", low, high)
    return figure


def _plot_discrepancy(diagnosis: Diagnosis) -> Figure | None:
    """Return the signal that would close the gap, over time and over what may drive it."""
    found = diagnosis.evidence.discrepancy
    if found is None or len(found.values) < 2:
        return None
    shown = describe_channel(found.quantity, found.unit)
    known = {name: values for name, values in diagnosis.evidence.motion.items() if len(values) == len(found.values)}
    motion = {name: values for name, values in known.items() if name in MOTIONS and residuals.varies(values)}
    grid = Grid((1.6,) * (1 + len(motion) // 2), columns=2, gap=(0.75, 0.6))
    title = f"The missing {shown.words} of the {found.block}"
    note = "What the simulation lacks to agree with the held-out run: over time, then over what moves or changes."
    page = style.make_page(title, note, grid)
    first, *panels = page.list_panels(1 + len(motion))
    style.draw_line(first, *thin_line(found.time, shown.factor * found.values), Entry("", COLOURS[6], width=1.0))
    first.set(xlabel="time [s]", ylabel=shown.axis)
    every = max(1, len(found.values) // DOTS)
    for axes, (name, values) in zip(panels, motion.items(), strict=True):
        places, lacking = MOTIONS[name].factor * values[::every], shown.factor * found.values[::every]
        axes.scatter(places, lacking, s=3, color=COLOURS[6], linewidths=0, rasterized=True)
        axes.set(xlabel=MOTIONS[name].axis, ylabel=shown.axis)
    return page.figure


def _plot_channels(traces: Sequence[Trace], looks: _Looks) -> dict[str, Figure]:
    """Return a picture of each channel by name, the channel with the largest nominal gap first."""
    groups = residuals.group_by_channel(traces).values()
    worst = [(max(group, key=lambda each: rms(_subtract(each, "nominal"))), group) for group in groups]
    ordered = sorted(worst, key=lambda pair: -residuals.nominal_gap(pair[0]))
    return {f"signal_{trace.channel}": _plot_channel(trace, group, looks) for trace, group in ordered}


def _plot_channel(trace: Trace, group: Sequence[Trace], looks: _Looks) -> Figure:
    """Return a picture of a channel: of its worst run over time, and of all of its runs over frequency."""
    shown = describe_channel(trace.channel, trace.unit)
    step, noise = (trace.time[-1] - trace.time[0]) / (len(trace.time) - 1), shown.factor * trace.noise_rms
    loudest = find_loudest(_subtract(trace, "nominal"), step, SECONDS, RASTER)
    window = Window(*(end + trace.time[0] for end in loudest))
    left_over = [[_subtract(each, name) for each in group] for name in reversed(looks)]
    density = [estimate_density(step, signals) for signals in ([each.measured for each in group], *left_over)]
    first = find_first(density)
    note = f"{window} of {trace.run}, where the difference has most energy; RMS over the whole run."
    below = [look._replace(label=f"{look.label} (below: difference)") for look in looks.values()]
    legend, grid = [MEASURED, *below, *[NOISE, _BAND] * bool(noise)], GRID
    if np.isfinite(first):
        note += f" Lowest panel: power densities of the measured signal and of what differs. {state_method(first)}"
    else:
        grid, legend = GRID._replace(heights=GRID.heights[:2]), [entry for entry in legend if entry is not NOISE]
    sizes = {look.label if len(looks) > 1 else "": rms(_subtract(trace, name)) for name, look in looks.items()}
    sizes |= {"noise": trace.noise_rms} if trace.noise_rms > 0 else {}
    figures = [f"{name} {format_number(shown.factor * size)}\u00a0{shown.unit}".strip() for name, size in sizes.items()]
    title = f"{shown.words[:1].upper()}{shown.words[1:]}, RMS difference: {', '.join(figures)}"
    figure, [[upper], [lower], *spectra] = style.make_page(title, note, grid, legend)
    inside = (trace.time >= window.start) & (trace.time <= window.end)
    # The first one, which is dashed, last: where two agree, both are seen.
    drawn = [(upper, trace.measured, MEASURED)]
    for name, look in reversed(looks.items()):
        drawn += [(upper, getattr(trace, name), look), (lower, _subtract(trace, name), look)]
    for axes, values, look in drawn:
        style.draw_line(axes, *thin_line(trace.time[inside], shown.factor * values[inside]), look)
    lower.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)
    upper.set_ylabel(fill(f"{shown.words} [{shown.unit}]", LETTERS))
    lower.set_ylabel(f"difference\n[{shown.unit}]")
    lower.yaxis.set_offset_position("right")
    for axes in (upper, lower):
        axes.set_xlim(*window)
        axes.set_xlabel("time [s]", labelpad=1)
    densities = [(places, shown.factor**2 * power) for places, power in density]
    if noise:
        lower.axhspan(-_SHADED * noise, _SHADED * noise, color=style.AREA, linewidth=0, zorder=0)
        # Its edges stand before the lines, which hide a band that they fill.
        lower.axhspan(-_SHADED * noise, _SHADED * noise, facecolor="none", edgecolor="black", linestyle=":", zorder=3)
        # The one-sided density of white noise of RMS s is 2 s^2 dt.
        densities.append((density[0][0], np.full(len(density[0][0]), 2 * noise**2 * step)))
    for [axes] in spectra:
        draw_densities(axes, densities, [MEASURED, *reversed(looks.values()), NOISE][: len(densities)], decades=DECADES)
        style.scale_frequency_axis(axes, first, 0.5 / step)
        axes.set_ylabel(f"power density\n[{shown.square}/Hz]")
    for axes in figure.axes:
        axes.yaxis.set_label_coords(-0.125, 0.5)
    return style.name_coincident(figure)


def _subtract(trace: Trace, name: str) -> Array:
    return np.asarray(trace.measured - getattr(trace, name))
