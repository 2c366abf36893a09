"""A seat and a bench in a few words, with and without effects."""

from dataclasses import replace

import numpy as np

from seatsim.dampers.bingham import Bingham
from seatsim.effects.base import off
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.loading import load
from seatsim.schema.registry import find, names, specification_of
from seatsim.simulation.augment import augment_damper, augment_factors, read_sensors, select_in_loop
from seatsim.simulation.damper_bench import bench_force
from seatsim.simulation.simulate import simulate

from ..text import beside

NAMES = names("effect")
STEP = 1e-3
BINGHAM = Bingham()
INERT = Bingham(0.0, 0.0, 0.0, 0.0)
"""A damper without any force."""
SEAT = beside(__file__, "shaken_seat.yaml")


def seat(folder, settings=None):
    """The scenario of a seat with a Bingham damper, shaken hard for three seconds."""
    path = folder / "seat.yaml"
    path.write_text(SEAT)
    return load(path, settings)[0]


def record(name, **values):
    """An effect by name, off but for these values."""
    return off(find("effect", name))._replace(**values)


CARRIER = record("damper.gas_spring")
"""An effect that is off, so that a rig without effects is compiled as one with them."""


def starts(name):
    """The effect at the start values of each of its forms."""
    cls = find("effect", name)
    return [off(cls)._replace(**form.fixed, **form.free) for form in specification_of(cls).forms]


def shaken(scenario, *effects):
    """The history of a scenario with effects, as its sensors tell it; one compiled loop for all effects of a rig."""
    history = simulate(replace(scenario, effects=effects), carry_all_effects=True)
    return read_sensors(effects, scenario.solver.step, history.channels)


def distance(history, reference):
    """Greatest difference of a channel, over that channel's greatest value."""
    sizes = {name: np.max(np.abs(np.nan_to_num(values))) for name, values in reference.items()}
    gaps = {name: np.max(np.abs(np.nan_to_num(history[name] - reference[name]))) for name in reference}
    return max(gap / (sizes[name] or 1.0) for name, gap in gaps.items())


def bench(effects, x, v, current=0.5, temperature=20.0, damper=BINGHAM, step=STEP, factors=TemperatureFactors()):  # noqa: B008 - immutable
    """The force in N of a damper with effects on it, every step; motion and current every half step."""
    carrier = [] if any(isinstance(effect, type(CARRIER)) for effect in effects) else [CARRIER]
    augmented, rest = augment_damper(damper, select_in_loop((*effects, *carrier))[0])
    return bench_force(augmented, x, v, current, temperature, step, augment_factors(effects, factors), rest)


def cycles(amplitude=0.005, frequency=1.0, count=3, step=STEP):
    """Displacement and velocity of a sine, every half step."""
    phase = 2 * np.pi * frequency * 0.5 * step * np.arange(round(2 * count / frequency / step) + 1)
    return amplitude * np.sin(phase), amplitude * 2 * np.pi * frequency * np.cos(phase)
