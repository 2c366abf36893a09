"""What a recording did not visit, and so cannot judge."""

import re

import numpy as np

from seatsim.recordings.quality.coverage import list_unvisited
from seatsim.recordings.recording import load_recording

from ...faulty_recordings import rewrite


def test_what_was_not_visited_is_said(copy):
    assert "no run is warmer than 20 degC: thermal fade cannot be assessed" in [*list_unvisited(load_recording(copy))]
    table = load_recording(copy).table("run-1")
    rewrite(copy, lambda f: f.assign(coil_current=0.4 + 0.01 * np.sin(f.time), damper_temperature=60.0))
    missing = " ".join(list_unvisited(load_recording(copy)))
    assert "current stays at 0.39 to 0.41 A: coil, remanence" in missing
    assert "thermal fade" not in missing
    stroke = re.search(r"travel stays within (-\d+) to (\d+) mm", missing)
    assert stroke and float(stroke[2]) >= np.floor(1e3 * np.max(table["suspension_displacement"]))
