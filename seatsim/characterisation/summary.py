"""What a characterisation found, and the tests that a bench made of a damper, made of a damper model."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, NamedTuple

from seatsim.characterisation.rows import WINDOW, Row, group_rows, has_same_motion, summarise_stretches
from seatsim.characterisation.sheet import BenchSheet, PeakForce
from seatsim.characterisation.steps import Response, measure_responses
from seatsim.characterisation.tabulate import make_sheet
from seatsim.recordings.bench_tables import BenchRecord, map_bench, note_unused
from seatsim.scenario.scenario import DamperChoice
from seatsim.scenario.sections import read_damper
from seatsim.schema.content import Form, Joined, Unwritten, show_record
from seatsim.schema.yaml_source import Source
from seatsim.simulation.damper_bench import SineTest, sine_test

_RUN_UP = 3.0
"""Seconds a sine runs at least before its last cycle is taken: models forget their start in that time."""


def load_damper(path: Path) -> DamperChoice:
    """Return the damper of a file, `{model: NAME, parameters: {...}, temperature_factors: {...}}`.

    It may stand under `damper`, as a scenario has it.

    Raises:
        InputError: the file is not as described.
    """
    source = Source(path)
    if "damper" in source.data:
        return read_damper(source.data["damper"], source, ("damper",))
    return read_damper(source.data, source, ())


def model_peaks(choice: DamperChoice, rows: Sequence[Row], window: float) -> list[PeakForce]:
    """Return the peak forces of a model in the tests of measured rows, each at the temperature that the row states.

    Raises:
        RunError: the damper's state ran away in one of the tests.
    """
    modelled = [row._replace(loop=_test_sine(choice, row)) for row in rows if row.loop is not None]
    return make_sheet(modelled, [], window).peak_forces


def _test_sine(choice: DamperChoice, row: Row) -> SineTest:
    """Return a cycle of a row's sine after which the model has forgotten its start."""
    warm = row.temperature if math.isfinite(row.temperature) else choice.factors.reference
    cycles = max(3, math.ceil(_RUN_UP * row.frequency) + 1)
    test = sine_test(choice.record, row.amplitude, row.frequency, row.current, warm, choice.factors, cycles)
    return test._replace(time=test.time - test.time[0])


class Characterisation(NamedTuple):
    """The rows of a damper's records, its responses to steps, and what is to be known of them.

    It is the content of `characterisation.json`. source: the data, as text. sheet: the tables of the bench day.
    """

    name: str
    source: str
    rows: Annotated[list[Row], Form(key="records")]
    responses: Unwritten[list[Response]]
    notes: list[str]
    sheet: Joined[BenchSheet]

    @property
    def remarks(self) -> list[str]:
        """Notes on the rows in sentences, records with the same note together."""
        affected: dict[str, list[str]] = {}
        for row in self.rows:
            for note in row.notes:
                affected.setdefault(note, []).append(row.record)
        for answer in self.responses:
            if answer.note:
                who = f"{answer.record}, step {answer.before:.2f} to {answer.after:.2f} A"
                affected.setdefault(answer.note, []).append(who)
        return [*self.notes, *(f"{_list_names(names)}: {note}" for note, names in affected.items())]

    def _repr_html_(self) -> str:
        return show_record(self)


def _list_names(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} and {len(names) - 1} more"


def characterise(
    data: str | Path | Sequence[BenchRecord],
    name: str = "",
    source: str = "",
    window: float = WINDOW,
    pattern: str = "",
    progress: Callable[[str], object] = lambda _: None,
) -> Characterisation:
    """Return what bench records, or the tables of a folder, show before anything is modelled.

    `window` is the part of the stroke over which the force at the peak speed is averaged; `pattern` is that of
    `seatsim.recordings.bench_tables.map_bench`; `progress` is called with what is done.

    A record whose current rests at several levels, with steady cycles at one of them, has a row for each such stretch;
    any other record has one row.
    """
    examine = partial(_examine, window)
    parts: Iterable[tuple[list[Row], list[Response], list[str]]]
    if isinstance(data, str | Path):
        name, parts = name or Path(data).stem, map_bench(data, examine, pattern)
    else:
        name, parts = name or data[0].name, [examine(data)]
    rows, responses, unused = list[Row](), list[Response](), list[str]()
    for number, (more_rows, more_responses, more_unused) in enumerate(parts, 1):
        rows += more_rows
        responses += more_responses
        unused += more_unused
        progress(f"tables characterised: {number}")
    sheet = make_sheet(rows, responses, window)
    return Characterisation(name, source or name, rows, responses, note_unused(unused), sheet)


def _examine(window: float, records: Iterable[BenchRecord]) -> tuple[list[Row], list[Response], list[str]]:
    """Return what some records show, without their samples: rows, responses, columns that are not used."""
    rows, responses, unused = list[Row](), list[Response](), list[str]()
    for record in records:
        rows += summarise_stretches(record, window)
        responses += measure_responses(record)
        unused += record.unused
    return rows, responses, unused


def group_by_setting(rows: Sequence[Row]) -> list[list[Row]]:
    """Return rows with cycles in groups of the same amplitude and frequency, in the order of these."""
    groups = group_rows([row for row in rows if row.loop is not None], has_same_motion)
    return sorted(groups, key=lambda group: (round(1e3 * group[0].amplitude), group[0].frequency))
