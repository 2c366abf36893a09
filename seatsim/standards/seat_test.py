"""The seat test of ISO 7096, on the scenario of a seat or on a recording of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from seatsim.excitations.iso7096 import SpectralClass
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError, nearest
from seatsim.standards.iso7096 import LIMITS
from seatsim.standards.recorded_seat import assess_recorded_seat
from seatsim.standards.seat_rows import SeatTest
from seatsim.standards.simulated_seat import assess_simulated_seats


def seat_test(
    source: str | Path,
    classes: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> SeatTest:
    """Put a seat to the test of ISO 7096: SEAT factors, damping at resonance, end stops.

    Args:
        source: a scenario, whose every variant is tested, or the folder of a recording.
        classes: spectral classes, all nine where empty.
        settings: values of the scenario by dotted key.
        progress: is called with the simulations done and all.

    Raises:
        InputError: the scenario or recording is wrong, or has no seat to test. RunError: a simulation failed.
    """
    chosen = find_classes(classes) or tuple(LIMITS)
    if (Path(source) / HEADER).exists():
        found = assess_recorded_seat(load_recording(source), chosen)
    else:
        found = assess_simulated_seats(load(source, settings), chosen, progress)
    return found._replace(source=Path(source).name)


def find_classes(names: Sequence[str]) -> tuple[SpectralClass, ...]:
    """Return spectral classes by name, whatever their case.

    Raises:
        InputError: there is no such class.
    """
    known = {name.lower(): name for name in LIMITS}
    for name in names:
        if name.lower() not in known:
            raise InputError(f"no class is called '{name}'{nearest(name, LIMITS)}; permitted: {', '.join(LIMITS)}")
    return tuple(known[name.lower()] for name in names)
