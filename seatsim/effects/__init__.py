"""Small physical changes of the rig, one file per block.

The writer of an effect needs `from seatsim.effects import Form, Plant, State, effect, param`. An effect is a record of
its parameters with methods by which it acts; `seatsim.effects.base` lists them. `seatsim new effect NAME` writes one.
"""

from seatsim.compilation.jit import jit
from seatsim.effects.base import Form, effect
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.state import State
from seatsim.schema.fields import param

__all__ = ["Coil", "Form", "Plant", "State", "effect", "jit", "param"]
