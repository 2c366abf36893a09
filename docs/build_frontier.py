"""Draw the trade of comfort against travel that each kind of seat offers on the rough ground of the quickstart.

Along every curve one number varies: the coefficient of a viscous damper, that of a hybrid skyhook, the weight of the
travel in the H-infinity synthesis. The points are runs of the quickstart at 20 degC; the limits are those of
`seatsim run --bracket`, which takes minutes. Writes `docs/images/frontier.png`.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

import seatsim
from seatsim.plots import style
from seatsim.plots.style import DARK, Entry, Grid
from seatsim.simulation.performance_bounds import compute_performance_bounds
from seatsim.simulation.result import Run

HERE = Path(__file__).parent


class Curve(NamedTuple):
    """Runs of a variant of the quickstart in which a dotted key takes several values."""

    entry: Entry
    variant: str
    key: str
    values: tuple[float, ...]


PASSIVE, SKYHOOK, SYNTHESISED, _ = style.make_entries(["viscous damper", "hybrid skyhook", "H-infinity gain", ""])
CURVES = (
    Curve(PASSIVE, "passive, best", "damper.parameters.c_a", (330.0, 400.0, 500.0, 650.0, 850.0, 1100.0, 1500.0)),
    Curve(SKYHOOK, "hybrid skyhook", "controller.damping", (700.0, 1000.0, 1300.0, 1700.0, 2300.0, 3000.0)),
    Curve(SYNTHESISED, "H-infinity", "controller.weights.travel", (1.6, 2.0, 2.3, 2.7, 3.2, 5.0)),
)
PUBLISHED = Entry("gain of Yu et al. 2019", "black", "none", mark="D")
BOUND = Entry("no damper without memory comes below", "black", width=1.6)
REACHED = Entry("best found of an ideal damper that knows the floor ahead", DARK, (0.0, (5.0, 1.5)), 1.6)
FLOOR = Entry("as much as the floor (SEAT = 1)", DARK, ":", 1.6)


def run_variant(variant: str, **settings: object) -> Run:
    """Return the run of a variant of the quickstart on its rough ground at 20 degC, without end stops."""
    content = yaml.safe_load((HERE.parent / "scenarios" / "quickstart.yaml").read_text(encoding="utf-8"))
    content = {key: value for key, value in content.items() if key not in ("sweep", "checks", "effects")}
    content["variants"] = {variant: content["variants"][variant] | settings}
    return seatsim.run(content).runs[0]


def place(run: Run) -> tuple[float, float]:
    """Return RMS travel in mm and Wk-weighted RMS acceleration in m/s^2 of a run."""
    found = run.metrics
    return 1e3 * found["suspension_displacement_rms"].value, found["driver_acceleration_weighted"].value


def main() -> None:
    """Run all, draw, write."""
    curves = [[run_variant(each.variant, **{each.key: value}) for value in each.values] for each in CURVES]
    published = run_variant("H-infinity", controller={"law": "static_output_feedback", "gain": [2.0, 2147.6]})
    ours = run_variant("H-infinity")
    ((_, bounds),) = compute_performance_bounds([ours], print)
    legend = [PASSIVE, SKYHOOK, SYNTHESISED, PUBLISHED, REACHED, BOUND, FLOOR]
    title = "An H-infinity gain that measures travel alone comes near the skyhook"
    note = (
        "Scraper (ISO 7096 EM2), damper at 20 °C, no end stops; lower left is better. Grey: travel of the quickstart."
    )
    page = style.make_page(title, note, Grid((3.4,)), legend)
    axes = page.rows[0][0]
    for curve, runs in zip(CURVES, curves, strict=True):
        travel, comfort = zip(*map(place, runs), strict=True)
        style.draw_line(axes, travel, comfort, curve.entry)
        axes.plot(travel, comfort, "o", color=curve.entry.colour, markersize=4)
    axes.plot(*place(published), "D", color=PUBLISHED.colour)
    across = np.linspace(5.0, 19.0, 200)
    style.draw_line(axes, across, bounds.bound(1e-3 * across), BOUND)
    style.draw_line(axes, across, bounds.best(1e-3 * across), REACHED)
    axes.axvline(place(ours)[0], color=style.GREY, linewidth=1.0)
    axes.axhline(
        ours.metrics["driver_acceleration_weighted"].value / ours.metrics["seat_factor"].value, color=DARK, ls=":"
    )
    axes.set_xlim(across[0], across[-1])
    axes.set_ylim(0.4, 1.6)
    axes.set_xlabel("RMS suspension travel [mm]")
    axes.set_ylabel("driver, Wk RMS [m/s²]")
    page.figure.savefig(HERE / "images" / "frontier.png")


if __name__ == "__main__":
    main()
