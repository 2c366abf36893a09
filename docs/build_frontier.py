"""Draw the trade of comfort against travel that each kind of seat offers on the scraper of the quickstart.

Along every curve one number varies: the coefficient of a viscous damper, that of a hybrid skyhook, the weight of the
travel in the H-infinity synthesis. The points are runs of the quickstart at 20 degC. Writes
`docs/images/frontier.png`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import yaml
from matplotlib.figure import Figure

import seatsim
from seatsim.metrics.table import COMFORT, SEAT, TRAVEL
from seatsim.plots import style
from seatsim.plots.runs.comparison import FLOOR
from seatsim.plots.saving import save_figure
from seatsim.plots.style import Entry, Grid, describe_metric
from seatsim.simulation.result import Run

HERE = Path(__file__).parent


class Curve(NamedTuple):
    """Runs of a variant of the quickstart in which a dotted key takes several values."""

    entry: Entry
    variant: str
    key: str
    values: tuple[float, ...]


# Of the quickstart's variants in their order, so that each has its colour of the quickstart's pictures.
SYNTHESISED, _, SKYHOOK, PASSIVE = style.make_entries(["H-infinity gain", "", "hybrid skyhook", "viscous damper"])
CURVES = (
    Curve(PASSIVE, "passive, best", "damper.parameters.c_a", (330.0, 400.0, 500.0, 650.0, 850.0, 1100.0, 1500.0)),
    Curve(SKYHOOK, "hybrid skyhook", "controller.damping", (700.0, 1000.0, 1300.0, 1700.0, 2300.0, 3000.0)),
    Curve(SYNTHESISED, "H-infinity", "controller.weights.travel", (1.6, 2.0, 2.3, 2.7, 3.2, 5.0)),
)
PUBLISHED = Entry("gain for Yu et al.'s seat", "black", "none", mark="D")
QUICKSTART = Entry("travel of the example's gain", style.GREY, width=1.0)
ACROSS = (5.0, 19.0)
"""RMS travel in mm that is shown."""


def run_variant(variant: str, **settings: object) -> Run:
    """Return the run of a variant of the quickstart on the scraper at 20 degC, without end stops."""
    content = yaml.safe_load((HERE.parent / "scenarios" / "quickstart.yaml").read_text(encoding="utf-8"))
    content = {key: value for key, value in content.items() if key not in ("sweep", "checks", "effects")}
    content["variants"] = {variant: content["variants"][variant] | settings}
    return seatsim.run(content).runs[0]


def place(run: Run) -> tuple[float, float]:
    """Return RMS travel in mm and Wk-weighted RMS acceleration in m/s^2 of a run."""
    return 1e3 * run.read_metric(TRAVEL), run.read_metric(COMFORT)


def draw(curves: Sequence[Sequence[Run]], published: Run, ours: Run) -> Figure:
    """Return the picture of the runs of each curve, and those of the two gains."""
    title = "An H-infinity gain on the travel comes near the skyhook"
    note = "Scraper (ISO 7096 EM2), damper at 20 °C, no end stops; lower left is better."
    legend = [*(curve.entry for curve in CURVES), PUBLISHED, QUICKSTART, FLOOR]
    figure, [[axes]] = style.make_page(title, note, Grid((3.4,)), legend)
    axes.axvline(place(ours)[0], color=QUICKSTART.colour, linewidth=QUICKSTART.width)
    axes.axhline(place(ours)[1] / ours.read_metric(SEAT), color=FLOOR.colour, linestyle=FLOOR.dashes)
    for curve, runs in zip(CURVES, curves, strict=True):
        travel, comfort = zip(*map(place, runs), strict=True)
        style.draw_line(axes, travel, comfort, curve.entry._replace(mark="."))
    style.draw_line(axes, [place(published)[0]], [place(published)[1]], PUBLISHED)
    axes.set(xlim=ACROSS, ylim=(0.4, 1.6))
    axes.set(xlabel=describe_metric(TRAVEL).axis, ylabel=describe_metric(COMFORT).axis)
    return figure


def main() -> None:
    """Run all, draw, write."""
    curves = [[run_variant(each.variant, **{each.key: value}) for value in each.values] for each in CURVES]
    published = run_variant("H-infinity", controller={"law": "static_output_feedback", "gain": [2.0, 2147.6]})
    ours = run_variant("H-infinity")
    save_figure(draw(curves, published, ours), HERE / "images" / "frontier.png")


if __name__ == "__main__":
    main()
