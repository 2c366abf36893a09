"""Pictures of the damper models: force over velocity and over displacement at a few currents, as one small SVG each."""

from __future__ import annotations

from urllib.parse import unquote

from seatsim.plots.loops import plot_model
from seatsim.plots.saving import render_inline


def draw_loops(name: str) -> str:
    """Return the picture of a model with the values of its record, as SVG on white paper."""
    drawing = unquote(render_inline(plot_model(name)).source.removeprefix("data:image/svg+xml,"))
    # The first thing that is drawn is the paper, which a page of either colour would show through.
    return drawing.replace("fill:none", "fill:white", 1) + "\n"
