"""All figures of a characterisation, and the response of the force to steps of the current."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.response import SHARES, Response
from seatsim.characterisation.summary import Characterisation
from seatsim.plots import style
from seatsim.plots.bench.loops import plot_loops
from seatsim.plots.bench.trends import plot_asymmetry, plot_energy
from seatsim.plots.style import GREY, Entry, Grid

MOST = 6
"""Most responses in a panel."""
SHOWN = 2.2
"""Length of a panel over the longest time to 95 %."""


def plot_characterisation(found: Characterisation) -> dict[str, Figure]:
    """Return the figures of a characterisation by name.

    `loops` is always there, `energy` and `asymmetry` where there are cycles, `steps` where a response was determined.
    """
    figures = {"loops": plot_loops(found)}
    if any(row.loop is not None for row in found.rows):
        figures |= {"energy": plot_energy(found), "asymmetry": plot_asymmetry(found)}
    if any(answer.share is not None for answer in found.responses):
        figures["steps"] = plot_steps(found)
    return figures


def plot_steps(found: Characterisation) -> Figure:
    """Return the share of the change that the force has covered over time, rise and fall of the current apart.

    Beside each the first-order lag of the same time to 95 %.
    """
    known = [answer for answer in found.responses if answer.share is not None]
    speeds = {f"{answer.speed:.3g} m/s" for answer in known if math.isfinite(answer.speed)}
    at = f" at {speeds.pop()}" if len(speeds) == 1 else ""
    note = f"Force{at}, from its level before to that after the step; dots: 5, 90, 95 %. Thin: first order, same t95."
    title = f"Response to steps of current: {found.name}"
    page = style.make_page(title, note, Grid((3.0,), columns=2, top=0.3, gap=(0.3, 0.0)))
    for axes, words in zip(page.rows[0], ("rises", "falls"), strict=True):
        _draw_responses(axes, [answer for answer in known if answer.rises == (words == "rises")][:MOST])
        style.set_title(axes, f"current {words}")
    page.rows[0][0].set_ylabel("share of the change [-]")
    page.rows[0][1].tick_params(labelleft=False)
    return page.figure


def _draw_responses(axes: Axes, shown: list[Response]) -> None:
    if not shown:
        return style.explain_empty(axes, "none determined")
    for level in SHARES:
        axes.axhline(level, color=GREY, linewidth=0.7, linestyle=(0.0, (1.0, 2.0)))
    end = SHOWN * max((a.t95 for a in shown if math.isfinite(a.t95)), default=0.05)
    lag = np.linspace(0.0, end, 200)
    for answer, colour in zip(shown, style.sample_colours("viridis", len(shown)), strict=True):
        assert answer.time is not None and answer.share is not None
        name = f"{round(answer.before, 2):g} to {round(answer.after, 2):g} A, {1e3 * answer.t95:.3g} ms"
        style.draw_line(axes, 1e3 * answer.time, answer.share, Entry(name, colour, width=1.7))
        axes.plot([1e3 * t for t in (answer.t5, answer.t90, answer.t95)], SHARES, "o", color=colour, markersize=4)
        axes.plot(1e3 * lag, 1.0 - np.exp(-answer.rate_95 * lag), color=colour, linewidth=0.8, alpha=0.8)
    axes.set(xlabel="time from the step [ms]", xlim=(-0.08e3 * end, 1e3 * end), ylim=(-0.25 - 0.17 * len(shown), 1.2))
    axes.set_yticks([0, 0.5, 1])
    axes.legend(title="step, t95", loc="lower right", fontsize=9, framealpha=0.9, alignment="left", handlelength=1.2)
