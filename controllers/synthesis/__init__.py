"""H-infinity synthesis of static output feedback."""

from controllers.synthesis.certify import Certificate
from controllers.synthesis.design import ClosedLoop, Design
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.solve import synthesise

__all__ = ["Certificate", "ClosedLoop", "Design", "GeneralisedPlant", "synthesise"]
