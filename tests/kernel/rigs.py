"""A rig in a few words: set up, run, and check the energy of what the compiled loop is asked to do."""

import numpy as np

from controllers.laws.constant import Replay
from seatsim.compilation.cached import compiled
from seatsim.kernel.generic import TrueModel
from seatsim.kernel.hooks import state_at_rest
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_data import CHANNELS, LoopInputs, LoopSetup, Timing
from seatsim.kernel.rig import Rig
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors, Thermal
from seatsim.schema.registry import specification_of

STEP = 1e-3
SEAT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
NONE = np.zeros(0)
COIL, NO_HEAT = Coil(), TemperatureFactors()
METRICS = ("frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current")


def rough(duration, step=STEP, rms=1.0, seed=0, low=1.0, high=12.0):
    """Random floor acceleration of 60 tones that fades in over half a second, shape (N,)."""
    rng = np.random.default_rng(seed)
    time = step * np.arange(round(duration / step) + 1)
    tones = np.cos(np.outer(time, 2 * np.pi * rng.uniform(low, high, 60)) + rng.uniform(0, 2 * np.pi, 60))
    return rms * np.sqrt(2 / 60) * tones.sum(axis=1) * np.minimum(1.0, 2 * time)


def refined(rows, times):
    """The same piecewise linear function, sampled `times` as often."""
    fine = np.arange((len(rows) - 1) * times + 1) / times
    return np.interp(fine, np.arange(len(rows)), rows)


def run(
    damper, law, floor, *, step=STEP, every=1, tolerance=1e-4, coil=COIL, plant=SEAT, model=None,
    effects=(), thermal=None, factors=NO_HEAT, temperature=20.0, replayed=NONE,
    prescribed=NONE, **start,
):  # fmt: skip
    """Run and return the history by channel, with `velocity` of the floor taken by the trapezoidal rule."""
    rows = len(floor)
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * (floor[1:] + floor[:-1])) * step])
    inputs = LoopInputs(floor, velocity, np.full(rows, temperature), replayed, prescribed, NONE, NONE, **start)
    timing = Timing(step, every, tolerance, thermal is not None)
    model = TrueModel(damper) if model is None else model
    rig, heat = Rig(plant, damper, effects), thermal or Thermal()
    setup = LoopSetup(rig, coil, factors, heat, law, model, timing, coil.max_current)
    out = np.empty((len(CHANNELS), rows)).T
    loop = compiled(run_loop, (type(damper), type(law), type(model.damper), *map(type, effects)))
    rest, followed = (specification_of(type(part)).initial for part in (damper, model.damper))
    at_rest = rest + state_at_rest([type(effect) for effect in effects])
    reached = loop(setup, inputs, at_rest, followed, (), out, np.empty(CELLS + 1))
    assert reached == rows, f"stopped at row {reached} of {rows}"
    return dict(zip(CHANNELS, out.T, strict=True)) | {"floor_velocity": velocity}


def driven(damper, floor, commands, **options):
    """Run with a given sequence of commanded currents in A, or with one that stands all the time."""
    commands = np.broadcast_to(np.asarray(commands, dtype=float), floor.shape).copy()
    return run(damper, Replay(), floor, replayed=commands, **options)


def imbalance(history, plant=SEAT):
    """Energy that is missing at the end, over the work of the floor or the energy dissipated if that is more."""
    v, w = (history[name][-1] for name in ("suspension_velocity", "cushion_velocity"))
    x, y = (history[name][-1] for name in ("suspension_displacement", "cushion_displacement"))
    kinetic = 0.5 * plant.frame_mass * v**2 + 0.5 * plant.driver_mass * (v + w) ** 2
    elastic = 0.5 * plant.suspension_stiffness * x**2 + 0.5 * plant.cushion_stiffness * y**2
    supplied = history["energy_floor"][-1]
    spent = sum(history[f"energy_{part}"][-1] for part in ("damper", "suspension", "cushion"))
    return abs(supplied - spent - kinetic - elastic) / max(abs(supplied), abs(spent))


def rms(values):
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def deviations(history, reference, names=METRICS):
    """Relative deviation of each rms value from the reference's."""
    return {name: abs(rms(history[name]) / rms(reference[name]) - 1.0) for name in names}
