"""All kinds of changes, gathered."""

from __future__ import annotations

from numpy.random import Generator

from seatsim.blind.carrier.change import Change, Drawer
from seatsim.blind.carrier.injections.coil import draw_delays, draw_limits
from seatsim.blind.carrier.injections.damper import draw_damper_changes
from seatsim.blind.carrier.injections.nominal import draw_faster_coils, draw_removals
from seatsim.blind.carrier.injections.seat import draw_seat_changes
from seatsim.blind.carrier.injections.sensor import draw_sensor_changes, draw_skewed_logs
from seatsim.blind.carrier.recorded import Carrier

DRAWERS: tuple[Drawer, ...] = (
    draw_damper_changes, draw_sensor_changes, draw_skewed_logs, draw_delays, draw_limits, draw_faster_coils,
    draw_seat_changes, draw_removals,
)  # fmt: skip


def draw_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return every change that a carrier allows, with what is random about each drawn."""
    return [change for draw in DRAWERS for change in draw(carrier, rng)]
