"""A small experiment, simulated once without any fault."""

from functools import cache
from typing import NamedTuple

import numpy as np

from seatsim.blind.make.draw_experiment import draw_experiment
from seatsim.blind.make.materiality import CommandedRuns, context_of
from seatsim.blind.truth.experiment import CHANNELS, Experiment, read_channels, simulate_run
from seatsim.blind.truth.faults import Changes, Context


class SmallExperiment(NamedTuple):
    """An experiment, what faults are scaled by, and its runs in open loop."""

    experiment: Experiment
    context: Context
    runs: CommandedRuns


@cache
def small_experiment(bingham=False):
    drawn = draw_experiment(np.random.default_rng(6), bingham, CHANNELS)
    experiment = drawn._replace(true=drawn.true | drawn.nominal)
    motions = [simulate_run(experiment, Changes(), k) for k in range(3)]
    context = context_of(experiment, [read_channels(experiment, Changes(), k, motions[k]) for k in range(3)])
    return SmallExperiment(experiment, context, CommandedRuns(experiment, [motion.command for motion in motions]))
