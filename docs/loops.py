"""Pictures of the damper models: force over velocity and over displacement at a few currents, as one small SVG each."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from seatsim.characterisation.model_tests import load_specimen
from seatsim.simulation.damper_bench import SineTest, sine_test

T = TypeVar("T", float, NDArray[np.float64])

AMPLITUDE, FASTEST = 0.01, 2.0
"""m and Hz of the sine; the frequency is lower where the model does not hold up to the speed."""
SHARES = (0.0, 0.5, 1.0)
"""Currents shown, as shares of the greatest for which the model holds."""
SETTLING = 3.0
"""Seconds that the sine runs at least before the cycle shown; models forget their start in that time."""
POINTS = 120
"""Points of a loop, at equal distances along it in the picture."""
COLOURS = ("#0072b2", "#d55e00", "#009e73")
WIDTH, HEIGHT, LEFT, TOP, GAP = 270.0, 190.0, 62.0, 34.0, 30.0
"""Size of a panel in pixels, its place, and the distance of the two."""


class Panel(NamedTuple):
    """One of the two pictures: where it begins, the ends of its axes, and what stands below it."""

    left: float
    across: float
    up: float
    title: str


def draw_loops(name: str) -> str:
    """Return the picture of a model with the values of its record."""
    specimen = load_specimen(name, None)
    known = specimen.specification
    frequency = min(FASTEST, math.floor(100.0 * known.max_speed / (2.0 * math.pi * AMPLITUDE)) / 100.0)
    currents = [share * known.max_current for share in SHARES] if known.max_current else [0.0]
    cycles = max(3, math.ceil(SETTLING * frequency) + 1)
    tests = [sine_test(specimen.damper, AMPLITUDE, frequency, i, 20.0, specimen.factors, cycles) for i in currents]
    return draw(name, f"sine of {1e3 * AMPLITUDE:g} mm at {frequency:g} Hz, 20 °C", currents, tests)


def draw(name: str, words: str, currents: list[float], tests: list[SineTest]) -> str:
    """Return the SVG of the last cycle of each test, with `words` on the test above it."""
    force = max(float(np.max(np.abs(test.force))) for test in tests)
    speed = max(float(np.max(np.abs(test.velocity))) for test in tests)
    right = LEFT + WIDTH + GAP
    panels = Panel(LEFT, speed, force, "velocity [m/s]"), Panel(right, AMPLITUDE, force, "displacement [m]")
    size = f"{right + WIDTH + 12:g}", f"{TOP + HEIGHT + 44:g}"
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" width="{size[0]}" '
        f'height="{size[1]}" font-family="sans-serif" font-size="12" role="img">',
        f"<title>Force of {name} over velocity and displacement</title>",
        '<rect width="100%" height="100%" fill="white"/>',
        *(line for panel in panels for line in draw_frame(panel)),
        f'<text x="{right + WIDTH:g}" y="18" text-anchor="end">{words}</text>',
        f'<text transform="translate(13 {TOP + HEIGHT / 2:g}) rotate(-90)" text-anchor="middle">force [N]</text>',
    ]
    for colour, current, test in zip(COLOURS, currents, tests, strict=False):
        for panel, across in zip(panels, (test.velocity, test.displacement), strict=True):
            path = trace(panel, across, test.force)
            lines.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
        place = LEFT + 80.0 * COLOURS.index(colour)
        lines.append(f'<text x="{place:g}" y="18" fill="{colour}">{current:g} A</text>')
    return "\n".join([*lines, "</svg>", ""])


def draw_frame(panel: Panel) -> list[str]:
    """Return the box of a panel, its zero lines, and the values at the ends of its axes."""
    bottom, middle = TOP + HEIGHT, panel.left + WIDTH / 2
    marks = [
        f'<rect x="{panel.left:g}" y="{TOP:g}" width="{WIDTH:g}" height="{HEIGHT:g}" fill="none" stroke="#999"/>',
        f'<path d="M{panel.left:g} {TOP + HEIGHT / 2:g}h{WIDTH:g}M{middle:g} {TOP:g}v{HEIGHT:g}" stroke="#ccc"/>',
        f'<text x="{middle:g}" y="{bottom + 36:g}" text-anchor="middle">{panel.title}</text>',
    ]
    decimals = 0 if panel.up >= 100.0 else 1
    for share in (-1.0, 0.0, 1.0):
        x, y = place_point(panel, share * panel.across, share * panel.up)
        marks.append(f'<text x="{x:.1f}" y="{bottom + 17:g}" text-anchor="middle">{share * panel.across:.2g}</text>')
        if panel.left == LEFT:
            marks.append(
                f'<text x="{LEFT - 5:g}" y="{y + 4:.1f}" text-anchor="end">{share * panel.up:.{decimals}f}</text>'
            )
    return marks


def trace(panel: Panel, across: NDArray[np.float64], force: NDArray[np.float64]) -> str:
    """Return the path of a closed loop, in tenths of a pixel."""
    x, y = place_point(panel, across, force)
    along = np.append(0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y))))
    kept = np.linspace(0.0, along[-1], POINTS)
    points = [f"{a:.1f} {b:.1f}" for a, b in zip(np.interp(kept, along, x), np.interp(kept, along, y), strict=True)]
    return "M" + "L".join([points[0], *(after for before, after in pairwise(points) if after != before)]) + "Z"


def place_point(panel: Panel, across: T, force: T) -> tuple[T, T]:
    """Return where points of a loop lie, with a margin of 5 %."""
    x = panel.left + WIDTH / 2 * (1.0 + 0.95 * across / panel.across)
    return x, TOP + HEIGHT / 2 * (1.0 - 0.95 * force / (panel.up or 1.0))
