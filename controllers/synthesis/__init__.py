"""H-infinity synthesis of static output feedback for any linear plant, with a certificate and a lower bound.

What belongs here knows matrices only: no seat, no damper, no scenario. The seat as a plant is `controllers.seat_plant`,
the law that uses a design is `controllers.laws.static_output_feedback`. From the top: solve asks search for a gain,
verify for what is true of it, and bound for what no controller can beat.
"""

from controllers.synthesis.certify import Certificate
from controllers.synthesis.design import ClosedLoop, Design, verify
from controllers.synthesis.global_proof import GlobalProof
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.solve import SEAT_TIME_BUDGET, find_gain, synthesise

__all__ = [
    "SEAT_TIME_BUDGET",
    "Certificate",
    "ClosedLoop",
    "Design",
    "GeneralisedPlant",
    "GlobalProof",
    "find_gain",
    "synthesise",
    "verify",
]
