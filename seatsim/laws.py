"""What the writer of a control law needs: `from seatsim.laws import Measurement, law, param`.

A law is a record of its keys with a method `wanted_current` or `wanted_force`; `seatsim.rig.control` describes all that
it may have, and `seatsim new controller NAME` writes one. The laws that come with seatsim are those of
`controllers.laws`.
"""

from seatsim.compilation.jit import jit
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, law
from seatsim.rig.plant import Plant
from seatsim.schema.fields import param

__all__ = ["Coil", "Measurement", "Plant", "jit", "law", "param"]
