"""Pictures of the damper models: force over velocity and over displacement at a few currents, as one small SVG each."""

from __future__ import annotations

import math
from urllib.parse import unquote

from seatsim.characterisation.model_tests import load_specimen
from seatsim.plots.loops import Family, plot_families
from seatsim.plots.saving import render_inline
from seatsim.simulation.damper_bench import sine_test

AMPLITUDE, FASTEST = 0.01, 2.0
"""m and Hz of the sine; the frequency is lower where the model does not hold up to the speed."""
SHARES = (0.0, 0.5, 1.0)
"""Currents shown, as shares of the greatest for which the model holds."""
SETTLING = 3.0
"""Seconds that the sine runs at least before the cycle shown; models forget their start in that time."""


def draw_loops(name: str) -> str:
    """Return the picture of a model with the values of its record, as SVG on white paper."""
    specimen = load_specimen(name, None)
    known = specimen.specification
    frequency = min(FASTEST, math.floor(100.0 * known.max_speed / (2.0 * math.pi * AMPLITUDE)) / 100.0)
    currents = [share * known.max_current for share in SHARES] if known.max_current else [0.0]
    cycles = max(3, math.ceil(SETTLING * frequency) + 1)
    loops = [
        (f"{i:g} A", sine_test(specimen.damper, AMPLITUDE, frequency, i, 20.0, specimen.factors, cycles))
        for i in currents
    ]
    title = f"sine of {1e3 * AMPLITUDE:g} mm at {frequency:g} Hz, 20 °C"
    figure = plot_families(name, "", [Family(title, "current", loops)])
    drawing = unquote(render_inline(figure).source.removeprefix("data:image/svg+xml,"))
    # The first thing that is drawn is the paper, which a page of either colour would show through.
    return drawing.replace("fill:none", "fill:white", 1) + "\n"
