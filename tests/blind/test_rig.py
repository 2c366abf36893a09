"""The true rig agrees with the nominal replay where nothing is wrong, and has converged."""

import numpy as np

from seatsim.blind.truth.rig import EXCITATION_RATE, INTEGRATION_STEP, Inputs, simulate
from seatsim.blind.truth.state import parameter_record

from .experiments import small_experiment


def test_the_step_is_fine_enough_for_a_steep_damper():
    experiment, _, runs = small_experiment(True)
    values = parameter_record(experiment.true)
    plan, law = experiment.runs[2], np.zeros(6)
    coarse, fine = (
        simulate(values, Inputs(plan.floor, EXCITATION_RATE, np.zeros(1), law, runs.commands[2]), step)
        for step in (INTEGRATION_STEP, INTEGRATION_STEP / 4)
    )
    for name in ("frame", "driver", "displacement", "force", "current"):
        a, b = getattr(coarse, name), getattr(fine, name)
        assert np.std(a - b) < 1e-3 * np.std(b)
