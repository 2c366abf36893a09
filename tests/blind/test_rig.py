"""The true rig agrees with the nominal replay where nothing is wrong, and has converged."""

import numpy as np
import pytest

import seatsim
from seatsim.blind.make.folder import encode_recording, write_folder
from seatsim.blind.truth.experiment import read_channels, simulate_run
from seatsim.blind.truth.faults import Changes
from seatsim.blind.truth.rig import EXCITATION_RATE, INTEGRATION_STEP, Inputs, simulate
from seatsim.blind.truth.state import parameter_record

from .experiments import small_experiment


@pytest.mark.parametrize("bingham", [False, True])
def test_a_faultless_rig_replays_to_within_its_noise(bingham, tmp_path):
    experiment, _, _ = small_experiment(bingham)
    shown = [read_channels(experiment, Changes(), k, simulate_run(experiment, Changes(), k)) for k in range(4)]
    folder = tmp_path / "case"
    write_folder(folder, encode_recording(experiment, shown, np.random.default_rng(0), [0, 1, 2, 3]))
    for run in ("run-a", "run-b", "run-c", "run-u"):
        gap = seatsim.gap(folder / "nominal.yaml", folder, [run])
        assert gap.overall <= 1.1 * gap.floor.overall


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
