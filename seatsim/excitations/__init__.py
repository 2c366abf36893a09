"""Excitations of the floor: random roads, machine spectra, tones, bumps and measured tables."""

from seatsim.excitations.base import Excitation, Floor, excitation
from seatsim.excitations.bumps import Bumps
from seatsim.excitations.iso7096 import Iso7096
from seatsim.excitations.periodic import Chirp, Rest, Sine, SteppedSine
from seatsim.excitations.road import TRUCK, Road, Vehicle, floor_response, state_space
from seatsim.excitations.table import Table

__all__ = [
    "TRUCK",
    "Bumps",
    "Chirp",
    "Excitation",
    "Floor",
    "Iso7096",
    "Rest",
    "Road",
    "Sine",
    "SteppedSine",
    "Table",
    "Vehicle",
    "excitation",
    "floor_response",
    "state_space",
]
