"""What a step of the compiled loop costs with each damper."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from seatsim.benchmark.measurement import Cost, compare_least, time_in_turns
from seatsim.benchmark.seat_run import DAMPER, make_floor, make_setup, prepare_run
from seatsim.dampers.base import DAMPERS

DURATION, SAMPLE_EVERY, REPEATS = 10.0, 5, 7
UNIT = "ns a step"


def measure_dampers(names: Sequence[str]) -> Iterator[Cost]:
    """Yield what a step costs with each damper at its defaults, beside one with the modified Bouc-Wen damper."""
    acceleration, beside = make_floor(DURATION), DAMPERS.name_of(type(DAMPER))
    reference, _ = prepare_run(acceleration, make_setup(SAMPLE_EVERY))
    for name in names:
        run, _ = prepare_run(acceleration, make_setup(SAMPLE_EVERY, DAMPERS.find(name)()))
        times = time_in_turns({"run": run, "reference": reference}, REPEATS)
        scale = 1e9 / len(acceleration)
        yield compare_least(name, times["run"], UNIT, scale, f"a step with {beside}", times["reference"])
