"""Figures of an identification: measured and predicted loops, and force over time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.identification.assessment import Assessment
from seatsim.identification.identify import Identification
from seatsim.plots import style
from seatsim.plots.loops import SIGNS
from seatsim.plots.style import MEASURED, Entry, Grid, clean_text
from seatsim.plots.thinning import spread_evenly
from seatsim.scenario.describe import name_model
from seatsim.schema.text import shorten_paths

MOST = 6
"""Most records that are drawn."""
SHOWN = 1200
"""Most rows of a record that are drawn, from the stretch with the highest speed."""
START = 0.3
"""s at the start of a record that are left out: there the state of the damper is not known."""
_PREDICTED = Entry("predicted", style.COLOURS[1], width=1.0)
_DIFFERENCE = Entry("measured less predicted", style.COLOURS[0], width=1.0)
_FIT = "Fit (normalised RMS): 100 % less the RMS error as a share of the measured force's standard deviation."
PARTS = {"train": "fitted", "test": "held out"}


def select_records(judged: Sequence[Assessment]) -> list[Assessment]:
    """Return records spread evenly over the held-out ones, or the fitted ones where none is held out.

    Held-out records come first because only they show how well the model predicts.
    """
    return spread_evenly([each for each in judged if each.part != "train"] or list(judged), MOST)


def name_records(judged: Sequence[Assessment]) -> list[str]:
    """Return the names of records, with as much of their folders as sets those apart that are called the same."""
    return shorten_paths([(*Path(each.record.folder).parts, each.record.name) for each in judged])


def plot_predictions(found: Identification) -> Figure:
    """Return force over velocity and over displacement of some records, and what is left of it over time.

    Held-out records come before fitted ones.
    """
    chosen = select_records(found.assessments)
    grid = Grid(heights=(1.9,) * len(chosen), columns=3, right=0.95, top=0.3, gap=(0.3, 0.8))
    note, mean = f"{len(chosen)} of {len(found.assessments)} records", found.assessed
    note += f"; mean fit {mean.fit_percent:.1f} %{' of held-out records' * bool(found.test)}" if mean else ""
    note += f", without the first {START:g} s. {_FIT} {SIGNS}"
    title, legend = f"{name_model(found.model)}: measured and predicted force", (MEASURED, _PREDICTED, _DIFFERENCE)
    page = style.make_page(title, note, grid, legend)
    for panels, judged, name in zip(page.rows, chosen, name_records(chosen), strict=True):
        title = f"{name} ({PARTS[judged.part]}), fit {judged.agreement.fit_percent:.1f} %"
        panels[0].set_title(clean_text(title, 64), loc="left", fontsize=style.FONT)
        _draw_record(panels, judged)
    return style.name_coincident(page.figure)


def _draw_record(panels: Sequence[Axes], judged: Assessment) -> None:
    record = judged.record
    first, last = record.liveliest(SHOWN)
    part = slice(max(first, min(int(np.searchsorted(record.time, record.time[0] + START)), last // 2)), last)
    motion = ((record.velocity, "velocity [m/s]"), (1e3 * record.displacement, "displacement [mm]"))
    for axes, (across, name) in zip(panels, motion, strict=False):
        style.draw_line(axes, across[part], record.force[part], MEASURED)
        style.draw_line(axes, across[part], judged.predicted[part], _PREDICTED)
        axes.set(xlabel=name, ylim=panels[0].get_ylim())
        axes.tick_params(labelleft=axes is panels[0])
    panels[0].set_ylabel("force [N]")
    style.draw_line(panels[2], record.time[part], record.force[part] - judged.predicted[part], _DIFFERENCE)
    panels[2].set(xlabel="time [s]", ylabel="difference [N]")
    panels[2].yaxis.set_label_position("right")
    panels[2].yaxis.tick_right()
    panels[2].spines[["left", "right"]].set_visible(True)
