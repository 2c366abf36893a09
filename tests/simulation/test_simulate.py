"""A run: its channels, its energy, its sampling, its warnings, and how several are put side by side."""

from dataclasses import replace

import numpy as np
import pytest

from seatsim.cli.outputs.simulated import make_comparison_table
from seatsim.metrics.table import Metric
from seatsim.scenario.loading import single
from seatsim.schema.registry import specification_of
from seatsim.simulation.result import Channel, History, Result
from seatsim.simulation.runs import run
from seatsim.simulation.validity import LARGEST_RESIDUAL, list_ranges_left, list_reasons


@pytest.fixture(scope="module")
def scenario(kept_seat_file):
    sine = {"kind": "sine", "amplitude": 0.02, "frequency": 1.0, "duration": 2.0}
    return single(kept_seat_file, {"excitation": sine})


def test_a_channel_has_a_unit_and_what_is_computed_from_it_has_none(scenario):
    found = run(scenario)
    force = found["damper_force"]
    assert (force.name, force.unit) == ("damper_force", "N")
    for part in (force[10:20], force[::2], force[force > 0.0], force[[1, 2]]):
        assert (part.name, part.unit) == ("damper_force", "N")
    computed = [2.0 * force, force * force, force / (force + 1e3), force > 0.0]
    computed += [np.cumsum(force), force.cumsum(), np.sqrt(force**2)]
    assert {(each.name, each.unit) for each in computed} == {("", "")}
    assert isinstance(force[0], float)
    with pytest.raises(ValueError, match="read-only"):
        force *= force
    assert Channel(np.zeros(2), "x", "m").shape == (2,)


def warned(scenario, share, speed=0.0, current=0.0, warmer=0.0):
    """The warnings of a run of which a share is at a speed, at a current, and warmer than the data at 20 degC."""
    at = np.arange(1000) < 1000 * share
    still = np.zeros(1000)
    return list_ranges_left(scenario, History(0.001, {"suspension_velocity": speed * at, "coil_current": current * at,
                                                   "damper_temperature": 20.0 + warmer * at,
                                                   "suspension_displacement": still}))  # fmt: skip


def test_a_range_left_for_more_than_a_hundredth_of_the_run_is_warned_of(kept_seat_file):
    scenario = single(kept_seat_file)
    stated = specification_of(type(scenario.damper.record))
    fast, strong = 1.01 * stated.max_speed, 1.01 * stated.max_current
    assert warned(scenario, 0.009, fast, strong) == ()
    if np.isfinite(stated.max_speed):
        (sentence,) = warned(scenario, 0.011, speed=-fast)
        assert f"faster than {stated.max_speed:g} m/s" in sentence
        geared = replace(scenario, plant=scenario.plant._replace(damper_ratio=0.5))
        assert warned(geared, 0.011, speed=-fast) == ()
    if np.isfinite(stated.max_current):
        (sentence,) = warned(scenario, 0.011, current=strong)
        assert f"above {stated.max_current:g} A" in sentence
    coldest, hottest = stated.temperatures
    for change in (coldest - 20.1, hottest - 19.9):
        assert warned(scenario, 0.009, warmer=change) == ()
        (sentence,) = warned(scenario, 0.011, warmer=change)
        assert f"{hottest:g} degC, beyond the data behind the model" in sentence


def figures(**values):
    """Metrics with the given values."""
    return {name: Metric(value, "-", name) for name, value in values.items()}


def test_a_figure_without_value_and_an_open_energy_balance_are_reasons(kept_seat_file):
    scenario, still = single(kept_seat_file), np.zeros(100)
    names = ("suspension_velocity", "coil_current", "suspension_displacement")
    history = History(0.001, {**dict.fromkeys(names, still), "damper_temperature": 20.0 + still})
    assert list_reasons(scenario, history, figures(driver_vdv=1.0, energy_residual=0.9 * LARGEST_RESIDUAL)) == ()
    for value in (np.nan, np.inf):
        (reason,) = list_reasons(scenario, history, figures(driver_vdv=value))
        assert reason == "driver_vdv has no finite value"
    (reason,) = list_reasons(scenario, history, figures(energy_residual=1.1 * LARGEST_RESIDUAL))
    assert "0.0011 of the energy is unaccounted for" in reason


def test_a_run_says_why_its_figures_are_unverified(kept_seat_file):
    sure = run(kept_seat_file).runs[0]
    (doubtful,) = run(kept_seat_file, {"excitation": {"kind": "rest", "duration": 4.0}}).runs
    assert sure.unverified == () and set(doubtful.unverified) <= set(doubtful.warnings)
    assert "seat_factor has no finite value" in doubtful.unverified
    assert Result([sure, doubtful]).rows[1]["unverified"] == "; ".join(doubtful.unverified)
    quiet = make_comparison_table([sure, doubtful, sure], "both")
    assert [next(iter(quiet.columns[0].cells)), list(quiet.columns[0].cells)[1][-1]] == ["seat", "*"]
    best = [cell for column in quiet.columns for cell in column.cells if "bold" in str(cell)]
    assert best and all("bold" not in str(list(column.cells)[1]) for column in quiet.columns)
