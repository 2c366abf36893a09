"""The report of a gap: how far a scenario is from a recording, channel by channel and run by run.

The figures by which a simulation is signed off stand with it: objective ratings, and the error beside its uncertainty.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.diagnosis.residuals import group_by_channel, list_traces, nominal_gap
from seatsim.metrics.motion import rms
from seatsim.plots.diagnosis import plot_all_of_gap
from seatsim.recordings.gap import Gap
from seatsim.report import formatting
from seatsim.report.blocks import Block, Items, Report, Table, show_pictures
from seatsim.report.composing import compose
from seatsim.report.formatting import format_noise, format_quantity, say_noise, scale_row, show_table
from seatsim.report.packing import MEASURED, pack_traces
from seatsim.schema.printing import UNKNOWN, format_percent

_NEAR_NOISE = 1.2
"""Gap over the noise of the sensors up to which nothing is left to explain."""
SMALLEST = 1e-4
"""Gap below which nothing is left to explain."""


def report_gap(name: str, found: Gap, command: str) -> Report:
    """Return the report of a gap with the runs that were compared.

    Args:
        name: of scenario and recording, for the head.
        found: the gap.
        command: what makes the report again.
    """
    figures, lines = plot_all_of_gap(found), {"measured": ("measured", MEASURED), "nominal": ("simulated", 1)}
    sections: dict[str, Sequence[Block]] = {
        "gaps": tabulate_gaps(found),
        "signals": [*show_pictures(figures, "signal_"), pack_traces(list_traces(found), lines)],
        "agreement": _show_agreement(found),
    }
    advice = formatting.choose_advice(use_scenario=_is_explained(found), diagnose=not _is_explained(found))
    return compose("gap", f"Gap: {name}", [say_gap(found)], advice, sections, found.notes, command)


def say_gap(found: Gap) -> str:
    """Return in a sentence how far a simulation is from its recording."""
    worst, size = max(found.channels.items(), key=lambda pair: pair[1])
    noise = f"{format_percent(found.overall)} of the recorded signals' spread; {say_noise(found.floor.overall)}"
    rest = f". It is furthest off in the {worst.replace('_', ' ')}, by {format_percent(size)}."
    return f"The simulation is off by {noise}{': there is nothing left to explain.' if _is_explained(found) else rest}"


def _is_explained(found: Gap) -> bool:
    """Return whether a gap is of the size of the sensors' noise, or smaller than any that matters."""
    return found.overall <= max(_NEAR_NOISE * found.floor.overall, SMALLEST)


def tabulate_gaps(found: Gap) -> list[Table]:
    """Return the gaps over all runs, then, where there are several, those of each."""
    rows = [["overall", format_percent(found.overall), format_noise(found.floor.overall), UNKNOWN, UNKNOWN]]
    each_run, runs = list[list[str]](), list(found.replayed)
    for name, traces in group_by_channel(list_traces(found)).items():
        words, unit = name.replace("_", " "), traces[0].unit
        left = np.concatenate([trace.measured - trace.nominal for trace in traces])
        sizes = [format_quantity(size, unit) for size in (rms(left), float(np.mean(left)))]
        rows.append([words, format_percent(found.channels[name]), format_noise(found.floor.channels[name]), *sizes])
        gaps = {trace.run: nominal_gap(trace) for trace in traces if np.ptp(trace.measured) > 0}
        each_run.append([words, *(format_percent(gaps.get(run)) for run in runs)])
    tables = show_table("gap", rows, 1, [0])
    if len(runs) > 1:
        caption = "Gap of each run, in per cent of the standard deviation of the signal in the run"
        tables.append(Table(caption, ["channel", *runs], each_run))
    return tables


def _show_agreement(found: Gap) -> list[Block]:
    """Return the ratings and the errors of the channels with what each figure means, nothing where there are none."""
    if not found.iso18571:
        return []
    ratings = [
        (name.replace("_", " "), *map("{:.3f}".format, (each.overall, *each[:4])), 1e3 * each.shift)
        for name, each in found.iso18571.items()
    ]
    meanings = Items([each.text for each in formatting.explain("ratings")])
    errors = [
        scale_row(name, each.unit, (each.error, each.u_val, each.u_num, each.u_input, each.u_d))
        for name, each in found.v_and_v.items()
    ]
    return [
        *show_table("ratings", ratings, 2),
        meanings,
        *show_table("errors", errors, 2),
        *formatting.explain("errors"),
    ]
