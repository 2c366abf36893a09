"""What a characterisation found, of measured records or of a model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

from seatsim.characterisation.response import Response, find_cycles
from seatsim.characterisation.rows import Row, summarise_aperiodic_record, summarise_record
from seatsim.characterisation.steps import find_plateaus, measure_responses
from seatsim.recordings.bench_tables import BenchRecord, load_bench, unused_columns
from seatsim.schema.content import Form, show_record

_SETTLED = 0.2
"""Seconds after a step of current from which on cycles are counted."""
_ALIKE = 0.05
"""Relative difference of amplitudes and frequencies that are the same setting."""
WARMER = 4.0
"""degC; least difference of temperatures that are different settings."""


class Characterisation(NamedTuple):
    """The rows of a damper's records (or of a model's tests), its responses to steps, and what is to be known of them.

    It is the content of `characterisation.json`. measured: whether the rows are of records. source: the data, or the
    model with its parameters, as text.
    """

    name: str
    source: str
    measured: bool
    rows: Annotated[list[Row], Form(key="records")]
    responses: Annotated[list[Response], Form(key="steps")]
    notes: list[str]

    @property
    def remarks(self) -> list[str]:
        """Notes on the rows in sentences, records with the same note together."""
        affected: dict[str, list[str]] = {}
        for row in self.rows:
            for note in row.notes:
                affected.setdefault(note, []).append(row.record)
        for answer in self.responses:
            if answer.note:
                who = f"step {answer.before:.2f} to {answer.after:.2f} A"
                affected.setdefault(answer.note, []).append(f"{answer.record}, {who}" if answer.record else who)
        return [*self.notes, *(f"{_list_names(names)}: {note}" for note, names in affected.items())]

    def _repr_html_(self) -> str:
        return show_record(self)


def _list_names(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} and {len(names) - 1} more"


def characterise(data: str | Path | Sequence[BenchRecord], name: str = "", source: str = "") -> Characterisation:
    """Return what bench records, or the tables of a folder, show before anything is modelled.

    A record whose current rests at several levels, with steady cycles at one of them, has a row for each such stretch;
    any other record has one row.
    """
    records = load_bench(data) if isinstance(data, str | Path) else data
    name = name or (Path(data).stem if isinstance(data, str | Path) else records[0].name)
    rows = [row for record in records for row in _rows(record)]
    answers = [answer for record in records for answer in measure_responses(record)]
    return Characterisation(name, source or name, True, rows, answers, unused_columns(records))


def _rows(record: BenchRecord) -> list[Row]:
    rests = find_plateaus(record.current, record.rate)
    if len(rests) < 2:
        return [summarise_record(record)]
    skipped = round(_SETTLED * record.rate)
    parts = [(rest, record.part(rest.first + skipped, rest.last)) for rest in rests if rest.last > rest.first + skipped]
    rows = [
        summarise_record(part)._replace(record=f"{record.name}, {rest.first / record.rate:.1f} s")
        for rest, part in parts
    ]
    cyclic = [row for row in rows if row.loop is not None]
    return cyclic or [summarise_aperiodic_record(record, find_cycles(record.displacement))]


def group_by_setting(rows: Sequence[Row]) -> list[list[Row]]:
    """Return rows with cycles in groups of the same amplitude and frequency, in the order of these."""
    groups = group_rows([row for row in rows if row.loop is not None], _same)
    return sorted(groups, key=lambda group: (round(1e3 * group[0].amplitude), group[0].frequency))


def group_rows(rows: Sequence[Row], alike: Callable[[Row, Row], bool]) -> list[list[Row]]:
    """Return rows in groups, each row with the first group whose first row is like it, in the order they come."""
    groups: list[list[Row]] = []
    for row in rows:
        group = next((group for group in groups if alike(group[0], row)), None)
        if group is None:
            groups.append([row])
        else:
            group.append(row)
    return groups


def _same(a: Row, b: Row) -> bool:
    return all(abs(p - q) <= _ALIKE * p for p, q in ((a.amplitude, b.amplitude), (a.frequency, b.frequency)))
