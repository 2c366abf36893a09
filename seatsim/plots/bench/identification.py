"""Figures of an identification: measured and predicted loops, and force over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.identification.assessment import Assessment
from seatsim.identification.identify import Identification
from seatsim.plots import labels, style
from seatsim.plots.style import Entry, Grid

MOST = 6
"""Most records that are drawn."""
SHOWN = 1500
"""Most rows of a record that are drawn, from the stretch with the highest speed."""
MEASURED, PREDICTED = Entry("measured", "#000000", width=1.6), Entry("predicted", style.COLOURS[1])


def plot_predictions(found: Identification) -> Figure:
    """Return force over velocity, over displacement and over time of some records, held-out ones before fitted ones."""
    chosen = _select_records(found.assessments)
    grid = Grid(heights=(2.2,) * len(chosen), columns=3, top=0.4, gap=(0.75, 0.95))
    drawn = {"train": "fitted", "test": "held out", "predicted": "predicted only"}
    mean = found.mean("test") or found.mean("train")
    note = f"{len(chosen)} of {len(found.assessments)} records; mean fit {mean.fit_percent:.1f} %" if mean else ""
    note += " of held-out records" if found.mean("test") else ""
    page = style.make_page(f"{found.model}: measured and predicted force", note, grid, (MEASURED, PREDICTED))
    for panels, judged in zip(page.rows, chosen, strict=True):
        title = labels.clean_text(judged.record.name, labels.LONGEST_TITLE)
        panels[0].set_title(f"{title} ({drawn[judged.part]}), fit {judged.agreement.fit_percent:.1f} %", loc="left")
        _draw_record(panels, judged)
    return page.figure


def _select_records(judged: Sequence[Assessment]) -> list[Assessment]:
    """Return records spread evenly over the held-out ones, or the fitted ones where none is held out.

    Held-out records come first because only they show how well the model predicts.
    """
    first = [each for each in judged if each.part != "train"] or list(judged)
    places = np.unique(np.linspace(0, len(first) - 1, min(MOST, len(first))).round().astype(int))
    return [first[place] for place in places]


def _draw_record(panels: Sequence[Axes], judged: Assessment) -> None:
    record = judged.record
    part = slice(*record.liveliest(SHOWN))
    for axes, across, name in (
        (panels[0], record.velocity, "velocity [m/s]"),
        (panels[1], 1e3 * record.displacement, "displacement [mm]"),
        (panels[2], record.time, "time [s]"),
    ):
        style.draw_line(axes, across[part], record.force[part], MEASURED)
        style.draw_line(axes, across[part], judged.predicted[part], PREDICTED)
        axes.set_xlabel(name)
    panels[0].set_ylabel("force [N]")
