"""All truth forms by name."""

from __future__ import annotations

from seatsim.blind.truth import damper as truths_damper
from seatsim.blind.truth import outside as truths_outside
from seatsim.blind.truth import seat as truths_seat
from seatsim.blind.truth import sensor as truths_sensor
from seatsim.blind.truth.truth import Truth

TRUTHS: dict[str, Truth] = {
    truth.name: truth
    for module in (truths_damper, truths_seat, truths_sensor, truths_outside)
    for truth in module.TRUTHS
}


def forms_of(effect: str) -> list[Truth]:
    """Return the forms of an effect of the contract, or of `outside`."""
    return [truth for truth in TRUTHS.values() if truth.effect == effect]
