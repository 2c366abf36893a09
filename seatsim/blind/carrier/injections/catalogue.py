"""All kinds of changes, gathered."""

from __future__ import annotations

from numpy.random import Generator

from seatsim.blind.carrier.change import Change, Drawer
from seatsim.blind.carrier.injections.coil import draw_delays, draw_limits
from seatsim.blind.carrier.injections.damper import draw_damper_changes
from seatsim.blind.carrier.injections.seat import draw_seat_changes
from seatsim.blind.carrier.injections.sensor import draw_sensor_changes, draw_skewed_logs
from seatsim.blind.carrier.recorded import Carrier

DRAWERS: tuple[Drawer, ...] = (
    draw_damper_changes, draw_sensor_changes, draw_skewed_logs, draw_delays, draw_limits, draw_seat_changes,
)  # fmt: skip


def draw_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return every change of the signals that a carrier allows, with what is random about each drawn.

    Header and nominal are those of the carrier in every case, so that they do not tell what was done.
    """
    return [change for draw in DRAWERS for change in draw(carrier, rng)]
