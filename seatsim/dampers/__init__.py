"""Damper models: one file per family, each with its equation, its parameters and their source.

The writer of a damper needs `from seatsim.dampers import State, TemperatureScaling, damper, param`. A damper is a
record of its parameters with a method `force`; `seatsim.dampers.base` describes all that it may have, and
`seatsim new damper NAME` writes one.
"""

from seatsim.compilation.jit import jit
from seatsim.dampers.base import damper
from seatsim.rig.state import State
from seatsim.rig.temperature import TemperatureFactors, TemperatureScaling
from seatsim.schema.fields import param

__all__ = ["State", "TemperatureFactors", "TemperatureScaling", "damper", "jit", "param"]
