"""Excitations of the floor: random roads, machine spectra, tones, bumps and measured tables."""

from seatsim.excitations.base import Excitation, Floor, excitation
from seatsim.excitations.bumps import Bumps
from seatsim.excitations.iso7096 import Iso7096
from seatsim.excitations.periodic import Chirp, Sine, SteppedSine
from seatsim.excitations.rest import Rest
from seatsim.excitations.road import Road
from seatsim.excitations.table import Table
from seatsim.excitations.vehicle import TRUCK, Vehicle, floor_response, state_space

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
