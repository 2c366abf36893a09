"""The run that is measured: an RD-1005-3 seat under sampled static output feedback, at 1 kHz."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from seatsim.compilation.cached import compiled
from seatsim.dampers.bouc_wen import ModifiedBoucWen
from seatsim.excitations.iso7096 import Iso7096
from seatsim.kernel.generic import DamperModel, TrueModel
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_data import CHANNELS, LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import Rig
from seatsim.rig.coil import Coil
from seatsim.rig.control import LAWS, Law, prepare_law
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.arrays import Array
from seatsim.schema.registry import initial_state

STEP = 1e-3
GAIN = (2.0, 2147.6)
PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
DAMPER = ModifiedBoucWen()


def make_floor(duration: float) -> Array:
    """Return the floor acceleration of ISO 7096 class EM5, linear between samples every `STEP` seconds."""
    return Iso7096(spectral_class="EM5", duration=duration).floor(STEP, seed=0).acceleration


def make_setup(sample_every: int, damper: DamperModel = DAMPER) -> LoopSetup:
    """Return the run's constant parts; the law is sampled every `sample_every` steps."""
    stated = cast("Law", LAWS.find("static_output_feedback")(gain=GAIN))
    law = prepare_law(stated, PLANT, Coil(), sample_every * STEP)
    model = TrueModel(damper)
    timing = Timing(STEP, sample_every, 1e-4, self_heating=False)
    factors, coil = TemperatureFactors(), Coil()
    return LoopSetup(Rig(PLANT, damper), coil, factors, Thermal(), law, model, timing, coil.max_current)


def prepare_run(acceleration: Array, setup: LoopSetup) -> tuple[Callable[[], None], Array]:
    """Return a function that runs the compiled loop, and the history that it fills; both are ready to be timed."""
    none, samples, damper = np.zeros(0), len(acceleration), type(setup.rig.damper)
    inputs = LoopInputs(acceleration, np.zeros(samples), np.full(samples, 20.0), none, none, none, none)
    history = np.empty((len(CHANNELS), samples)).T
    loop, rest = compiled(run_loop, (damper, type(setup.law))), initial_state(damper)

    def run() -> None:
        if loop(setup, inputs, rest, rest, (), history, np.empty(CELLS + 1)) != samples:
            raise RuntimeError("the solution left all bounds")

    run()
    return run, history
