"""Draw `images/loops/NAME.svg`: force over velocity and over displacement of each damper, for the reference.

`python docs/build_loops.py [NAME ...]` draws those named, or those without a picture. Nothing is compiled for so few
cycles.
"""

from __future__ import annotations

import math
import os
import re
import sys
from io import StringIO
from pathlib import Path

os.environ["NUMBA_DISABLE_JIT"] = "1"

import matplotlib.pyplot as plt

from seatsim.schema import registry
from seatsim.simulation.damper_bench import SineTest, sine_test

FOLDER = Path(__file__).with_name("images") / "loops"
FREQUENCY = 1.0
"""Hz; of the sine."""
MOST_SPEED = 0.1
"""m/s; peak speed of the sine, where the range of the model reaches that far."""
COLOURS = ("#9ecae1", "#3182bd", "#08306b")
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "seatsim", "font.family": "sans-serif", "font.size": 9}


def test_damper(name: str) -> dict[float, SineTest]:
    """Return a cycle of a damper at its own values, without current, at half of its range and at all of it."""
    cls = registry.find("damper", name)
    known = registry.specification_of(cls)
    amplitude = min(MOST_SPEED, known.max_speed) / (2.0 * math.pi * FREQUENCY)
    currents = [share * known.max_current for share in (0.0, 0.5, 1.0)]
    return {
        each: sine_test(cls(), amplitude, FREQUENCY, each, known.temperatures[0], known.factors, 3, 160)
        for each in currents
    }


def draw_loops(name: str) -> str:
    """Return the picture of a damper as SVG."""
    tests = test_damper(name)
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(1, 2, figsize=(7.2, 2.6), sharey=True, layout="constrained")
        for colour, (current, test) in zip(COLOURS, tests.items(), strict=True):
            panels[0].plot(test.velocity, test.force, color=colour, label=f"{current:g} A")
            panels[1].plot(1e3 * test.displacement, test.force, color=colour)
        panels[0].set(xlabel="velocity [m/s]", ylabel="force [N]")
        panels[1].set(xlabel="displacement [mm]")
        panels[0].legend(frameon=False)
        for panel in panels:
            panel.grid(color="#dddddd", linewidth=0.6)
        buffer = StringIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None})
        plt.close(figure)
    return re.sub(r"\d+\.\d{2,}", lambda number: f"{float(number[0]):.1f}", buffer.getvalue())


def main() -> None:
    """Draw the dampers named on the command line, or those that have no picture."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    missing = [name for name in registry.names("damper") if not (FOLDER / f"{name}.svg").exists()]
    for name in sys.argv[1:] or missing:
        (FOLDER / f"{name}.svg").write_text(draw_loops(name), encoding="utf-8")
        print(name, flush=True)


if __name__ == "__main__":
    main()
