"""What to do next after simulated runs: what was seen in them, and what trials of changes showed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.plots.labels import format_number
from seatsim.plots.runs.naming import label_runs
from seatsim.report.alternatives import SAME, read_metric
from seatsim.report.formatting import format_quantity
from seatsim.report.headline import count_times
from seatsim.scenario.scenario import condition_of
from seatsim.schema.errors import RunError
from seatsim.schema.text import join_names, name_some
from seatsim.simulation.result import Run
from seatsim.simulation.trials import STRETCH, try_changes

SEAT, HITS, _PEAK = "seat_factor", "end_stop_hits", "suspension_displacement_peak"


def advise_on_runs(runs: Sequence[Run]) -> list[str]:
    """Return what to do next, each in a sentence or two; the worst run comes first, and others are counted."""
    named = [(f"“{name}”", run) for name, run in zip(label_runs(runs), runs, strict=True) if not run.unverified]
    found = []
    hitting = _rank_above(named, HITS, 0.0)
    if hitting:
        counts = [f"{name} ({count_times(read_metric(run, HITS))})" for name, run in hitting]
        found.append(f"Look at the travel of {name_some(counts)}: the suspension meets its end stops.")
    amplifying = _rank_above(named, SEAT, 1.0 + SAME)
    if amplifying:
        listed = [f"{name} (SEAT factor {format_number(read_metric(run, SEAT))})" for name, run in amplifying]
        feels = f"The driver feels more than the floor moves in {name_some(listed)}."
        found.append(f"{feels}{_say_trials(*amplifying[0])}")
    if len(runs) == 1:
        found.append("Compare it with other laws or settings: seatsim compare takes several scenarios or a sweep.")
    elif len({condition_of(run.scenario) for run in runs}) == 1:
        found.append("Check that the order holds on other roads and with other drivers: seatsim sweep varies both.")
    return found


def _rank_above(named: Sequence[tuple[str, Run]], metric: str, limit: float) -> list[tuple[str, Run]]:
    """Return the runs with a metric above a limit, the largest first."""
    above = [(name, run) for name, run in named if read_metric(run, metric) > limit]
    return sorted(above, key=lambda pair: -read_metric(pair[1], metric))


def _say_trials(name: str, run: Run) -> str:
    """Return what halving and doubling the numbers of the worst run did to its SEAT factor."""
    try:
        own, *trials = try_changes(run.scenario)
    except RunError:
        return ""
    known = [each for each in trials if np.isfinite(each.metrics[SEAT].value)] if SEAT in own.metrics else []
    if not known:
        return ""
    best = min(known, key=lambda each: each.metrics[SEAT].value)
    keys = join_names(list(dict.fromkeys(each.key for each in known)))
    part = f"the first {STRETCH:g} s of " if run.history["time"][-1] > STRETCH else ""
    tried = f" Half and twice of {keys} were tried on {part}{name}"
    before, after = own.metrics[SEAT].value, best.metrics[SEAT].value
    if after > (1 - SAME) * before:
        return f"{tried}: none lowers its SEAT factor of {format_number(before)}."
    peaks = (format_quantity(each.metrics[_PEAK].value, "m") for each in (best, own))
    return (
        f"{tried}: {best.key} {best.value:g} lowers its SEAT factor the most, to {format_number(after)} from"
        f" {format_number(before)}, with travel up to {' in place of '.join(peaks)}."
    )
