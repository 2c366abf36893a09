"""Fault hypotheses: the block that a planted fault lies in, and what is said of it."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.localise.localisation import evaluate_hypotheses
from seatsim.diagnosis.localise.reconstruction import PORTS

from .toy import CHANNELS, SKIP, evaluate_nominal, plant, pose, record, slow_signal, weigh_stated

RUNS = {"first": 400, "second": 300}


def make_objective(folder, channels=CHANNELS[:4], **kept):
    return weigh_stated(pose(record(folder, runs=RUNS, channels=channels, noise=0.02, **kept)))


def evaluate(objective):
    return evaluate_hypotheses(objective, objective.linearise_nuisances(evaluate_nominal(objective)))


def plant_everywhere(objective, block, rms=40.0):
    """Return the hypotheses where every run has a signal in a block more, and those signals."""
    runs = enumerate(objective.problem.runs)
    signals = {run: slow_signal(objective.problem.measured[run].shape[1], rms, seed) for seed, run in runs}
    return evaluate(plant(objective, PORTS[block], signals)), signals


def likeliest(found):
    return min(found, key=lambda block: found[block].negative_log_evidence)


@pytest.mark.parametrize("block", ["damper", "suspension", "cushion", "driver", "floor"])
def test_a_planted_signal_is_likeliest_in_its_block(folder, block):
    found, signals = plant_everywhere(make_objective(folder), block, 0.5 if block == "floor" else 40.0)
    assert set(found) == {"damper", "suspension", "cushion", "driver", "floor", "sensor"}
    assert likeliest(found) == block
    ranked = sorted(each.negative_log_evidence for each in found.values())
    assert ranked[0] < 1.0 and ranked[1] > ranked[0] + 1.0
    assert (found[block].quantity, found[block].unit) == (
        ("acceleration", "m/s^2") if block == "floor" else ("force", "N")
    )
    assert found[block].channel == "" and list(found[block].signals) == ["first", "second"]
    for run, signal in signals.items():
        assert np.std(found[block].signals[run] - signal) < 0.35 * np.std(signal)


def test_an_error_of_one_channel_is_that_sensors(folder):
    objective = make_objective(folder)
    measured = {run: values.copy() for run, values in objective.problem.measured.items()}
    for seed, values in enumerate(measured.values()):
        values[2] += slow_signal(values.shape[1], 0.01, seed)
    problem = dataclasses.replace(objective.problem, measured=measured)
    found = evaluate(dataclasses.replace(objective, problem=problem))
    sensor = found["sensor"]
    assert likeliest(found) == "sensor"
    assert (sensor.quantity, sensor.unit, sensor.channel) == (
        "error of suspension_displacement",
        "m",
        "suspension_displacement",
    )
    residual = problem.measured["first"][2] - problem.simulated("first", problem.nominal, ())[2]
    assert np.allclose(sensor.signals["first"], residual)


def test_without_a_load_cell_damper_and_suspension_are_one(folder):
    with_it, without = (
        plant_everywhere(make_objective(folder, channels), "suspension")[0] for channels in (CHANNELS[:4], CHANNELS[:3])
    )
    assert with_it["damper"].negative_log_evidence > with_it["suspension"].negative_log_evidence + 1.0
    assert without["damper"].negative_log_evidence == without["suspension"].negative_log_evidence
    assert likeliest(without) == "damper"


def test_a_coil_is_asked_where_its_current_is_recorded(folder):
    commands = {run: 0.4 + 0.2 * np.sin(np.arange(SKIP + rows) / 7.0) for run, rows in RUNS.items()}
    objective = make_objective(folder, CHANNELS, commands=commands)
    problem, measured = objective.problem, {}
    for seed, run in enumerate(problem.runs):
        more = slow_signal(problem.measured[run].shape[1], 0.1, seed)
        floor = problem.inputs[run].floor
        flowing = np.zeros(len(floor.acceleration))
        flowing += np.interp(np.arange(len(flowing)) / problem.parts, SKIP + np.arange(len(more)), more, 0.0, 0.0)
        driven = floor._replace(command=floor.command + flowing)
        measured[run] = (
            problem.measured[run]
            + problem.simulated(run, problem.nominal, (), problem.inputs[run]._replace(floor=driven))
            - problem.simulated(run, problem.nominal, ())
        )
    found = evaluate(dataclasses.replace(objective, problem=dataclasses.replace(problem, measured=measured)))
    assert likeliest(found) == "coil"
    assert (found["coil"].quantity, found["coil"].unit, found["coil"].channel) == ("current", "A", "")
