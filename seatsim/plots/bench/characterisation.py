"""All figures of a characterisation, and the response of the force to steps of the current."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from seatsim.characterisation.response import Response
from seatsim.characterisation.sheet import StepResponse
from seatsim.characterisation.summary import Characterisation
from seatsim.plots import style
from seatsim.plots.bench.loops import plot_loops
from seatsim.plots.bench.trends import plot_asymmetry, plot_energy, plot_warm_up
from seatsim.plots.style import GREY, Entry, Grid
from seatsim.plots.thinning import spread_evenly

MOST = 6
"""Most responses in a panel."""
SHOWN = 3.6
"""Length of a panel over the longest time to 90 %."""
SYMMETRIC = 1e-3
"""Asymmetric part over the RMS force up to which it is no more than rounding and noise."""
_TIMES = (("t10", 0.1), ("t63", 1.0 - math.exp(-1.0)), ("t90", 0.9))
"""Times that are marked, with the shares of the change that they are of."""


def plot_characterisation(found: Characterisation) -> dict[str, Figure]:
    """Return the figures of a characterisation by name.

    `loops` is always there, `energy` where there are cycles, `asymmetry` where one of them has some, `steps` where a
    response was determined, `warm_up` where a record has many cycles.
    """
    figures = {"loops": plot_loops(found)}
    if any(row.loop is not None for row in found.rows):
        figures["energy"] = plot_energy(found)
    if any(row.asymmetry > SYMMETRIC for row in found.rows):
        figures["asymmetry"] = plot_asymmetry(found)
    if any(answer.share is not None for answer in found.responses):
        figures["steps"] = plot_steps(found)
    if found.sheet.warm_up:
        figures["warm_up"] = plot_warm_up(found)
    return figures


def plot_steps(found: Characterisation) -> Figure:
    """Return the share of the change that the force has covered over time, rise and fall of the current apart."""
    answers = [answer for answer in found.responses if answer.share is not None]
    known = list(zip(answers, found.sheet.response, strict=True))
    speeds = {f"{answer.speed:.3g} m/s" for answer in answers if math.isfinite(answer.speed)}
    at = f", at {speeds.pop()}" if len(speeds) == 1 else ""
    starts = {True: "the current's own 10 %", False: "the commanded step"}
    start = " or ".join(starts[own] for own in sorted({math.isfinite(each.current_t10) for each in answers}))
    note = f"Share of the force's change that is covered{at}. Time counts from {start}."
    title = f"Response to steps of current: {found.name}"
    shown = [spread_evenly([pair for pair in known if pair[0].rises == rises], MOST) for rises in (True, False)]
    if (count := sum(map(len, shown))) < len(known):
        note += f" {count} of {len(known)} steps are shown."
    # The legends stand below the panels, where they cover nothing.
    room = 0.75 + style.LINE * max(map(len, shown))
    page = style.make_page(title, note, Grid((3.0,), columns=2, top=0.3, bottom=room, gap=(0.3, 0.0)))
    for axes, words, pairs in zip(page.rows[0], ("rises", "falls"), shown, strict=True):
        _draw_responses(axes, pairs)
        style.set_title(axes, f"current {words}")
    page.rows[0][0].set_ylabel("share of the change [-]")
    page.rows[0][1].tick_params(labelleft=False)
    return style.name_coincident(page.figure)


def _draw_responses(axes: Axes, shown: list[tuple[Response, StepResponse]]) -> None:
    if not shown:
        return style.explain_empty(axes, "none determined")
    end = SHOWN * max((row.t90 for _, row in shown if math.isfinite(row.t90)), default=0.05)
    top = 1.2
    for (answer, row), colour in zip(shown, style.sample_colours("viridis", len(shown)), strict=True):
        assert answer.time is not None and answer.share is not None
        start = answer.current_t10 if math.isfinite(answer.current_t10) else 0.0
        name = f"{round(answer.before, 2):g} to {round(answer.after, 2):g} A"
        style.draw_line(axes, 1e3 * (answer.time - start), answer.share, Entry(name, colour, width=1.7))
        for time, share in _TIMES:
            axes.plot(1e3 * getattr(row, time), share, "o", color=colour, markersize=4)
        top = max(top, float(np.max(answer.share)) + 0.05)
    for time, share in _TIMES:
        axes.axhline(share, color=GREY, linewidth=0.7, linestyle=(0.0, (1.0, 2.0)))
        words = _say_time(time, [row for _, row in shown])
        axes.text(0.99e3 * end, share - 0.02, words, fontsize=9, horizontalalignment="right", verticalalignment="top")
    axes.set(xlabel="time [ms]", xlim=(-0.08e3 * end, 1e3 * end), ylim=(-0.15, top))
    axes.set_yticks([0, *(share for _, share in _TIMES)], ["0", *(f"{share:.2g}" for _, share in _TIMES)])
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.17), fontsize=style.FONT, frameon=False, borderaxespad=0)


def _say_time(time: str, rows: Sequence[StepResponse]) -> str:
    """Return a time in words, of all responses of a panel together."""
    known = sorted(round(1e3 * value, 1) + 0.0 for row in rows if math.isfinite(value := getattr(row, time)))
    ends = " to ".join(f"{each:g}" for each in sorted({*known[:1], *known[-1:]}))
    return f"{time} = {ends} ms" if known else f"{time} is not reached"
