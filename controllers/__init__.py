"""Control laws for semi-active seats, and the synthesis of H-infinity static output feedback."""

from controllers.synthesis import Design, GeneralisedPlant, synthesise

__all__ = ["Design", "GeneralisedPlant", "synthesise"]
