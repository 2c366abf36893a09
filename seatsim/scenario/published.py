"""Published figures in a scenario file, next to which the table puts its own.

    published:
      source: where the figures stand
      rows:
        - {variant: I, temperature: 80.0, driver_acceleration_rms: 0.908}

A row names a run by what sets it apart, and gives metrics of it in SI units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, cast

from seatsim.metrics.table import METRICS
from seatsim.schema.validation import check_keys, is_finite_number, mapping
from seatsim.schema.yaml_source import Source


class Published(NamedTuple):
    """The published figures of a file: where they stand, and a row for each run, of labels and metrics in SI units."""

    source: str
    rows: list[Mapping[str, object]]

    def figure(self, row: int, metric: str) -> float:
        """Return a metric that a row states."""
        return float(cast("float", self.rows[row][metric]))


def published_figures(source: Source) -> Published | None:
    """Return the published figures of a file that `check_published` has passed, or None where it has none."""
    if "published" not in source.data:
        return None
    stated = mapping(source.data["published"], source, ("published",))
    rows = cast("list[Mapping[str, object]]", stated["rows"])
    return Published(str(stated.get("source", "published figures")), rows)


def check_published(source: Source, labels: Sequence[str]) -> None:
    """Raise InputError where published figures of the file are not of the form above; `labels` set its runs apart."""
    if "published" not in source.data:
        return
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
            if not is_finite_number(value):
                raise source.error((*keys, name), f"{value!r} is not permitted; it must be a finite number")
