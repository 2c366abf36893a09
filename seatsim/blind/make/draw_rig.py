"""Draws the rig of a case before what is wrong with it: damper, channels, protocol; and what measures faults on it."""

from __future__ import annotations

from functools import cached_property

from numpy.random import Generator

from seatsim.blind.make.draw_experiment import SCATTER, draw_experiment
from seatsim.blind.make.draw_varied import draw_varied_experiment
from seatsim.blind.make.materiality import COARSE_STEP, CommandedRuns
from seatsim.blind.make.tolerance import ToleranceRefit
from seatsim.blind.truth.experiment import CHANNELS, Experiment, context_of, read_channels, simulate_run
from seatsim.blind.truth.faults.scenario import Changes

BINGHAM_SHARE = 0.5
"""Of the rigs."""
COMPLETE_SHARE, AT_MOST_ONE_MISSING = 0.6, 0.93
"""Shares of the rigs that record every channel, and that lack at most one; the others lack two."""
OPTIONAL = {"damper_force": 0.7, "coil_current": 0.3}
"""Channels that a rig may lack, and how likely each is the one: a load cell is what is saved first.

A fade could not be found without thermometer, so that no rig lacks it, whatever is wrong with it.
"""


def draw_rig(
    rng: Generator, varied: bool = False, missing: tuple[str, ...] | None = None, scatter: float = SCATTER,
    background: float = 0.0,
) -> Experiment:  # fmt: skip
    """Draw a rig and its protocol; what is to be wrong with it is not known here, so that nothing of it tells that.

    `missing` are the channels not recorded (None: drawn); a `varied` rig draws scatter and background itself.
    """
    gone = draw_missing_channels(rng) if missing is None else missing
    channels = tuple(name for name in CHANNELS if name not in gone)
    bingham = rng.random() < BINGHAM_SHARE
    if varied:
        return draw_varied_experiment(rng, bingham, channels)
    return draw_experiment(rng, bingham, channels, scatter, background)


def draw_missing_channels(rng: Generator) -> tuple[str, ...]:
    """Draw the channels that are not recorded: none in 60 % of cases, rarely two."""
    u = rng.random()
    if u < COMPLETE_SHARE:
        return ()
    count = 1 if u < AT_MOST_ONE_MISSING else 2
    return tuple(str(name) for name in rng.choice(list(OPTIONAL), count, replace=False, p=list(OPTIONAL.values())))


class FaultlessRig:
    """A drawn rig, and what measures faults on it; it stays the same whatever is drawn to be wrong with it."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        recorded = range(len(experiment.runs) - 1)
        motions = [simulate_run(experiment, Changes(), k, step=COARSE_STEP) for k in recorded]
        self.runs = CommandedRuns(experiment, [motion.command for motion in motions])
        self.context = context_of(experiment, [read_channels(experiment, Changes(), k, motions[k]) for k in recorded])

    @cached_property
    def refit(self) -> ToleranceRefit:
        """What the nominal's tolerance explains of a fault."""
        return ToleranceRefit(self.experiment, self.runs.commands)
