"""Gaps, model error and refitted parameters of every run, and what the error of a channel is made of."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.validate import list_gaps, replay_runs, state_model_error
from seatsim.recordings.gap import measure_gap
from seatsim.recordings.validation import budget_errors, carry_input_noise, measure_step_error
from seatsim.scenario.loading import single

from .toy import SIZES, TAPS, Added, make_scenario, offer, place, pose, record

RUNS = {"first": 300, "second": 240, "third": 360}


@pytest.fixture(scope="module")
def posed(folder):
    problem = pose(record(folder, (Added("one", 1.0),), RUNS))
    nominal = single(folder / "nominal.yaml")
    rigs = place(problem), place(problem, deviations=[0.5, 0.0]), place(problem, (offer("x", "one"), 0.9))
    return problem, [make_scenario(problem, nominal, rig) for rig in rigs]


def test_the_gaps_of_every_run_are_those_of_the_command(posed):
    problem, scenarios = posed
    found = list_gaps(problem, replay_runs(problem, scenarios))
    assert [each.run for each in found] == list(RUNS)
    for each in found:
        for figures, scenario in zip((each.before, each.calibrated, each.after), scenarios, strict=True):
            expected = measure_gap(scenario, problem.recording, [each.run])
            assert (figures.overall, figures.channels) == (expected.overall, expected.channels)
            assert each.floor.overall == expected.floor.overall
        assert each.shrink == 1.0 - each.after.overall / each.before.overall


def test_the_model_error_is_that_of_the_last_scenario(posed):
    problem, scenarios = posed
    found = state_model_error(problem, replay_runs(problem, scenarios))
    assert found.runs == tuple(RUNS) and list(found.noise) == list(problem.channels)
    worse = state_model_error(problem, replay_runs(problem, scenarios[:1]))
    assert all(np.mean(worse.pooled[name]) > 3.0 * np.mean(found.pooled[name]) for name in problem.channels)


def test_an_error_is_divided_into_what_noise_makes_and_the_form(posed):
    problem, scenarios = posed
    budget = budget_errors(scenarios[0], problem.recording, "second", problem.channels)
    gaps = measure_gap(scenarios[0], problem.recording, ["second"]).channels
    measured = problem.recording.table("second")
    for k, each in enumerate(budget):
        assert each.channel == problem.channels[k] and each.unit == "m/s^2"
        assert each.comparison_error == pytest.approx(gaps[each.channel] * np.std(measured[each.channel][200:]))
        assert (each.u_num, each.u_input, each.u_d) == (0.0, 0.0, 0.05)
        assert each.comparison_error**2 == pytest.approx(each.model_form**2 + each.u_d**2)
    right = budget_errors(
        make_scenario(problem, scenarios[0], place(problem, (offer("x", "one"), 1.0))), problem.recording, "first",
        problem.channels,
    )  # fmt: skip
    assert all(each.model_form < 0.5 * each.u_d for each in right)


def test_the_noise_of_the_floor_is_carried_to_the_channels(posed):
    problem, scenarios = posed
    channels = problem.recording.channels
    noisy = channels | {"floor_acceleration": channels["floor_acceleration"]._replace(noise_rms=0.1)}
    recording = dataclasses.replace(problem.recording, channels=noisy)
    found = carry_input_noise(scenarios[0], recording, recording.table("third"))
    expected = [0.1 * size * np.hypot(*taps) for size, taps in zip(SIZES[:2], TAPS["floor"], strict=False)]
    assert [found[name] for name in problem.channels] == pytest.approx(expected, rel=0.1)
    assert all(value == 0.0 for value in measure_step_error(scenarios[0], recording, recording.table("third")).values())
