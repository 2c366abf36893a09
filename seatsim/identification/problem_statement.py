"""From records to the problems that a fit solves: the whole one, and a short one for the global search."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatsim.identification.adjustment import fix_parameters, rescale_damper
from seatsim.identification.coordinates import Coordinates
from seatsim.identification.damper_record import DamperRecord, find_specification
from seatsim.identification.prediction import RecordInputs, prepare_inputs
from seatsim.identification.problem import IdentificationProblem, weight_records
from seatsim.identification.scales import Scales
from seatsim.identification.settings import IdentificationSettings
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.schema.errors import InputError
from seatsim.schema.fields import describe

SEARCH_ROWS = 10000
"""Rows of all records together that count in the global search."""
LEAST_SEARCH_ROWS = 300
"""Rows of a record that it takes at least."""
LEAST_WARMING = 5.0
"""K that the temperature must vary by for its influence to be fitted."""
LEAST_CURRENT = 1e-3
"""A; records that hold less hold none: a law stretched to the rounding of a current has no meaning."""
OFF_CENTRE = 0.25
"""Middle of all motion, over half its range, from which on it counts as the origin of the displacement."""


def find_origin(records: Sequence[BenchRecord]) -> float:
    """Return the displacement in m that counts as x = 0: 0, or the middle of all motion where that is far from it."""
    low = min(float(np.min(record.displacement)) for record in records)
    high = max(float(np.max(record.displacement)) for record in records)
    middle = 0.5 * (low + high)
    return round(middle, 4) if abs(middle) > OFF_CENTRE * 0.5 * (high - low) else 0.0


def state_problem(
    records: Sequence[BenchRecord],
    cls: type[DamperRecord],
    origin: float,
    settings: IdentificationSettings,
    known: DamperRecord | None = None,
) -> tuple[IdentificationProblem, IdentificationProblem]:
    """Return the problem of fitting a class to whole records, and to the liveliest stretch of each.

    The fit starts from `known`, a record of the class, or from the defaults of the class where there is none.

    Raises:
        InputError: nothing moves, the class has a number without default, or what is fixed is none of its numbers or
            all of them.
    """
    coordinates = _choose_coordinates(records, cls, settings, known)
    reference = None if settings.ignore_temperature else _reference_temperature(records)
    fits_coil = any(record.commanded for record in records)
    inputs = [prepare_inputs(record, origin, False) for record in records]
    rows = max(LEAST_SEARCH_ROWS, SEARCH_ROWS // len(records))
    stretches = [record.liveliest(rows) for record in records]
    short = [_with_run_up(record, stretch, origin) for record, stretch in zip(records, stretches, strict=True)]
    parts = [record.part(*stretch) for record, stretch in zip(records, stretches, strict=True)]
    whole = IdentificationProblem(coordinates, inputs, weight_records(records, inputs), fits_coil, reference)
    return whole, whole._replace(inputs=short, weights=weight_records(parts, short))


def _choose_coordinates(
    records: Sequence[BenchRecord],
    cls: type[DamperRecord],
    settings: IdentificationSettings,
    known: DamperRecord | None,
) -> Coordinates:
    """Return the free parameters, from defaults with their laws stretched to the largest current of the data."""
    scales = _measure_scales(records)
    start = fix_parameters(known or _default_record(cls, scales.current or 1.0), settings.fix)
    fixed = (*find_specification(cls).fixed, *settings.fix)
    coordinates = Coordinates(start, scales, fixed, _count_levels(records))
    if not coordinates.components:
        raise InputError(
            f"--fix {', '.join(settings.fix)} leaves no parameter of {cls.__name__} to fit; leave one free"
        )
    return coordinates


def _default_record(cls: type[DamperRecord], current: float) -> DamperRecord:
    """Return a class at its defaults, with its laws stretched to a current in A."""
    blank = [specification.name for specification in describe(cls) if specification.required]
    if blank:
        raise InputError(f"{cls.__name__}: a fit starts from defaults; give {', '.join(blank)} one")
    return rescale_damper(cls(), 1.0, current)


def _measure_scales(records: Sequence[BenchRecord]) -> Scales:
    force = float(np.sqrt(np.mean(np.concatenate([record.force for record in records]) ** 2)))
    stroke = max(float(np.std(record.displacement)) for record in records)
    speed = max(float(np.std(record.velocity)) for record in records)
    if min(force, stroke, speed) == 0.0:
        raise InputError("the records hold no motion or no force; identify a damper from records in which it moves")
    current = max(float(np.max(record.current)) for record in records)
    return Scales(force, stroke, speed, current if current >= LEAST_CURRENT else 0.0)


def _count_levels(records: Sequence[BenchRecord]) -> int | None:
    """Return the number of constant currents, None where the current varies within a record."""
    if any(np.ptp(record.current) > 0.0 for record in records):
        return None
    return len({round(record.mean_current, 3) for record in records})


def _reference_temperature(records: Sequence[BenchRecord]) -> float | None:
    """Return the mean temperature in degC, None where it was not recorded or hardly varies."""
    warmth = [record.temperature for record in records if record.temperature is not None]
    if len(warmth) < len(records) or max(map(np.max, warmth)) - min(map(np.min, warmth)) <= LEAST_WARMING:
        return None
    return float(np.mean(np.concatenate(warmth)))


def _with_run_up(record: BenchRecord, stretch: tuple[int, int], origin: float) -> RecordInputs:
    """Return the inputs of a stretch and of as many rows before it, in which the state forgets its start at rest."""
    first, last = stretch
    begin = max(0, 2 * first - last)
    found = prepare_inputs(record.part(begin, last), origin, False)
    return found._replace(counted=round((first - begin) / record.rate / found.step))
