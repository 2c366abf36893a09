"""Response of the force to steps of the current, and the first-order lag of the same time to 95 % for comparison."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.response import SHARES, Response
from seatsim.characterisation.summary import Characterisation
from seatsim.plots import style
from seatsim.plots.style import GREY, Entry, Grid

MOST = 6
"""Most responses in a panel."""
SHOWN = 2.2
"""Length of a panel over the longest time to 95 %."""


def plot_steps(found: Characterisation) -> Figure:
    """Return the share of the change that the force has covered over time, rise and fall of the current apart."""
    known = [answer for answer in found.responses if answer.share is not None]
    speeds = {f"{answer.speed:.3g} m/s" for answer in known if math.isfinite(answer.speed)}
    at = f" at {speeds.pop()}" if len(speeds) == 1 else ""
    note = f"Force{at}, from its level before to that after the step; dots: 5, 90, 95 %. Thin: first order, same t95."
    title = f"Response to steps of current: {found.name}"
    page = style.make_page(title, note, Grid((3.0,), columns=2, top=0.3, gap=(0.3, 0.0)))
    for axes, rises in zip(page.rows[0], (True, False), strict=True):
        chosen = [answer for answer in known if answer.rises == rises]
        _draw_responses(axes, chosen)
        axes.set_title("current rises" if rises else "current falls", loc="left", fontsize=style.FONT)
    page.rows[0][0].set_ylabel("share of the change [-]")
    page.rows[0][1].tick_params(labelleft=False)
    return page.figure


def _draw_responses(axes: Axes, answers: list[Response]) -> None:
    if not answers:
        style.explain_empty(axes, "none determined")
        return
    for level in SHARES:
        axes.axhline(level, color=GREY, linewidth=0.7, linestyle=(0.0, (1.0, 2.0)))
    shown = answers[:MOST]
    end = SHOWN * max((a.t95 for a in shown if math.isfinite(a.t95)), default=0.05)
    for answer, colour in zip(shown, style.sample_colours("viridis", len(shown)), strict=True):
        if answer.time is None or answer.share is None:
            continue
        name = f"{round(answer.before, 2):g} to {round(answer.after, 2):g} A, {1e3 * answer.t95:.3g} ms"
        style.draw_line(axes, 1e3 * answer.time, answer.share, Entry(name, colour, width=1.7))
        times = np.array([answer.t5, answer.t90, answer.t95])
        axes.plot(1e3 * times, SHARES, "o", color=colour, markersize=4)
        lag = np.linspace(0.0, end, 200)
        axes.plot(1e3 * lag, 1.0 - np.exp(-answer.rate_95 * lag), color=colour, linewidth=0.8, alpha=0.8)
    axes.set_xlim(-0.08e3 * end, 1e3 * end)
    axes.set_xlabel("time from the step [ms]")
    axes.set_ylim(-0.25 - 0.17 * len(shown), 1.2)
    axes.set_yticks([0, 0.5, 1])
    axes.legend(title="step, t95", loc="lower right", fontsize=9, framealpha=0.9, alignment="left", handlelength=1.2)
