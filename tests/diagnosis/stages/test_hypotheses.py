"""Fault hypotheses: the evidence against the dense Gaussian formula, and the block that a planted fault lies in."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from seatsim.diagnosis.localise import localisation
from seatsim.diagnosis.localise.input_estimate import PORTS, InputEstimate
from seatsim.diagnosis.localise.localisation import evaluate_hypotheses
from seatsim.diagnosis.objective import Evaluation, Linearisation, Parameters

from .toy import CHANNELS, SKIP, evaluate_nominal, plant, pose, record, slow_signal, weigh_stated

PRIOR = 0.58
SIZES = {"a": (2, 3), "b": (2, 4)}
"""Channels and frequencies of two tiny runs."""


def draw_tiny(rng, nuisances):
    """Return random estimates by run and a linearisation about a rig that is off by some deviations."""
    estimates, jacobian = {}, {}
    for run, (channels, bins) in SIZES.items():
        response = rng.standard_normal((channels, bins)) + 1j * rng.standard_normal((channels, bins))
        residuals = rng.standard_normal((channels, 2 * bins))
        estimates[run] = InputEstimate(residuals, response, rng.uniform(0.1, 3.0, bins), np.zeros(1))
        jacobian[run] = rng.standard_normal((nuisances, residuals.size))
    rig = Parameters(rng.uniform(-0.5, 0.5, nuisances))
    return estimates, Linearisation(Evaluation(rig, {}, {}, 0.0), jacobian)


def stack_dense(estimates, nuisances):
    """Return residuals, Jacobian and covariance of all real and imaginary parts, frequency by frequency."""
    parts, columns, blocks = [], [], []
    for run, (residuals, response, power, _) in estimates.items():
        channels, bins = response.shape
        jacobian = nuisances.jacobian[run].reshape(-1, channels, 2 * bins)
        for f in range(bins):
            outer = np.eye(channels) + np.outer(response[:, f], response[:, f].conj()) * power[f] / 2.0
            blocks.append(np.block([[outer.real, -outer.imag], [outer.imag, outer.real]]))
            parts.append(np.concatenate([residuals[:, f], residuals[:, bins + f]]))
            columns.append(np.concatenate([jacobian[:, :, f], jacobian[:, :, bins + f]], axis=1))
    covariance = np.zeros([sum(len(block) for block in blocks)] * 2)
    at = 0
    for block in blocks:
        covariance[at : at + len(block), at : at + len(block)] = block
        at += len(block)
    return np.concatenate(parts), np.concatenate(columns, axis=1), covariance


@pytest.mark.parametrize("nuisances", [0, 1, 3])
def test_the_evidence_is_that_of_the_dense_gaussian(nuisances):
    rng = np.random.default_rng(nuisances)
    for _ in range(5):
        estimates, linearisation = draw_tiny(rng, nuisances)
        # Residuals that deviations beyond their bounds would explain best.
        shift = 2.0 * rng.standard_normal(nuisances)
        for run, estimate in estimates.items():
            more = (shift @ linearisation.jacobian[run]).reshape(estimate.residuals.shape)
            estimates[run] = estimate._replace(residuals=estimate.residuals + more)
        residuals, jacobian, covariance = stack_dense(estimates, linearisation)
        now = linearisation.evaluation.parameters.deviations
        inverse = np.linalg.inv(covariance)
        shift = np.zeros(nuisances)
        if nuisances:
            root = np.linalg.cholesky(inverse).T
            rows = np.vstack([root @ jacobian.T, np.eye(nuisances) / PRIOR])
            target = np.concatenate([root @ residuals, -now / PRIOR])
            shift = lsq_linear(rows, target, (-1.0 - now, 1.0 - now), tol=1e-14).x
        left = residuals - shift @ jacobian
        expected = (left @ inverse @ left + np.linalg.slogdet(covariance)[1]) / len(residuals) - 1.0
        found = localisation._negative_log_evidence(linearisation, estimates)
        assert found == pytest.approx(expected, abs=1e-5)


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
    stated = ("acceleration", "m/s^2") if block == "floor" else ("force", "N")
    assert (found[block].quantity, found[block].unit) == stated
    assert found[block].channel == "" and list(found[block].signals) == ["first", "second"]
    for run, signal in signals.items():
        assert np.std(found[block].signals[run] - signal) < 0.35 * np.std(signal)


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
        moved = problem.simulated(run, problem.nominal, (), problem.inputs[run]._replace(floor=driven))
        measured[run] = problem.measured[run] + moved - problem.simulated(run, problem.nominal, ())
    found = evaluate(dataclasses.replace(objective, problem=dataclasses.replace(problem, measured=measured)))
    assert likeliest(found) == "coil"
    assert (found["coil"].quantity, found["coil"].unit, found["coil"].channel) == ("current", "A", "")
