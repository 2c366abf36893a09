"""The benchmark's run: 60 s at 1 kHz of an RD-1005-3 seat under sampled static output feedback."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from controllers.laws.static_output_feedback import OutputFeedback
from seatsim.compilation.cached import compiled
from seatsim.dampers.bouc_wen import ModifiedBoucWen
from seatsim.excitations.iso7096 import Iso7096
from seatsim.kernel.assumed_model import TrueModel
from seatsim.kernel.channels import CHANNELS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_inputs import LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import Rig
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, Thermal

STEP = 1e-3
GAIN = OutputFeedback(2.0, 2147.6)
PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
DAMPER = ModifiedBoucWen()
REST = (0.0, 0.0)


def floor(duration: float) -> np.ndarray:
    """Return the floor acceleration of ISO 7096 class EM5, linear between samples every `STEP` seconds."""
    return Iso7096(spectral_class="EM5", duration=duration).floor(STEP, seed=0).acceleration


def setup(sample_every: int, tolerance: float = 1e-4) -> LoopSetup:
    """Return the run's constant parts; the law is sampled every `sample_every` steps."""
    rig = Rig(PLANT, DAMPER)
    timing = Timing(STEP, sample_every, tolerance, self_heating=False)
    return LoopSetup(
        rig, Coil(), TemperatureFactors(), Thermal(), GAIN, TrueModel(DAMPER, 0), timing, Coil().max_current
    )


def seatsim_run(acceleration: np.ndarray, parts: LoopSetup) -> tuple[Callable[[], None], np.ndarray]:
    """Return a function that runs seatsim's compiled loop, and the history that it fills."""
    none, samples = np.zeros(0), len(acceleration)
    inputs = LoopInputs(acceleration, np.zeros(samples), np.full(samples, 20.0), none, none, none, none)
    history = np.empty((len(CHANNELS), samples)).T
    loop = compiled(run_loop, (ModifiedBoucWen, OutputFeedback))

    def run() -> None:
        if loop(parts, inputs, REST, REST, (), history) != samples:
            raise RuntimeError("the solution left all bounds")

    return run, history
