"""Published figures in a scenario file, beside which the table puts its own.

    published:
      source: where the figures stand
      rows:
        - {variant: I, temperature: 80.0, driver_acceleration_rms: 0.908}

A row names a run by what sets it apart, and gives metrics of it in SI units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from seatsim.metrics import METRICS
from seatsim.schema.validation import check_keys, mapping
from seatsim.schema.yaml_source import Source


def check_published(source: Source, labels: Sequence[str]) -> None:
    """Raise InputError where the file's published figures are not of the form above; `labels` set its runs apart."""
    published = mapping(source.data["published"], source, ("published",))
    check_keys(published, ("source", "rows"), source, ("published",))
    rows = published.get("rows")
    if not isinstance(rows, list) or not rows:
        raise source.error(
            ("published", "rows"), "a list of at least one row, such as '- {variant: I, seat_factor: 0.8}'"
        )
    for index, row in enumerate(rows):
        keys = ("published", "rows", index)
        naming = [key for key in mapping(row, source, keys) if key in labels or "." in key]
        check_keys(row, [*naming, "variant", "temperature", *METRICS], source, keys)
        for name in [name for name in row if name in METRICS]:
            value = row[name]
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise source.error((*keys, name), f"{value!r} is not permitted; it must be a finite number")
