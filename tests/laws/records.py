"""Every registered law, with the keys it must have, in the compiled form of one seat."""

from seatsim.rig.coil import Coil
from seatsim.rig.control import prepare_law
from seatsim.rig.plant import Plant
from seatsim.schema import registry

REQUIRED = {
    "constant": {"current": 0.5},
    "static_output_feedback": {"gain": (2.0, 2147.6)},
    "scheduled_output_feedback": {"temperatures": (20.0, 80.0), "gains": ((2.0, 2147.6), (2.0, 2800.0))},
}
SEAT, COIL = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0), Coil(130.0, 1.0)
LAWS = [name for name in registry.names("law") if name != "replay"]


# Laws that switch; one that cancels the spring and leaves it to the clip to be a damper; a plan that is always clipped.
NOT_LINEAR = ["on_off_skyhook", "acceleration_driven", "skyhook_add", "clipped_optimal", "power_driven", "mpc"]
LINEAR = [name for name in LAWS if name not in {*NOT_LINEAR, "constant"}]


def ready(name, sample_time=0.005, plant=SEAT, **keys):
    """Return the compiled form of a law and its state at rest."""
    cls = registry.find("law", name)
    law = cls(**REQUIRED.get(name, {}), **keys)
    return prepare_law(law, plant, COIL, sample_time), registry.specification_of(cls).initial
