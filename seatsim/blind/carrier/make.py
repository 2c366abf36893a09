"""Makes a set of sealed cases on a measured recording: some of its runs, one change of a drawn size in each."""

import dataclasses
import functools
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.damper import draw_damper_changes
from seatsim.blind.carrier.readings import draw_delays, draw_limits, draw_sensor_changes, draw_skewed_logs
from seatsim.blind.carrier.recorded import Altered, Carrier, Change, encode_carrier, read_carrier
from seatsim.blind.carrier.replays import Ruler
from seatsim.blind.carrier.seat import draw_seat_changes
from seatsim.blind.make.make import CaseFiles, make_set
from seatsim.blind.make.materiality import MATERIAL_SHARE
from seatsim.blind.sealed import Label
from seatsim.schema.errors import InputError
from seatsim.schema.processes import Progress

_WEAKEST, _STRONGEST = 0.06, 0.3
"""Standard deviations of a compared channel by which a change moves it: just material, and strong."""
_MOST_RUNS = 6
"""Of a case, one of which may be withheld: a diagnosis is to take seconds."""
_CLOSE = 0.1
"""Relative difference of a size from the one drawn that is close enough."""
_EVALUATIONS = 12
_DRAWERS = (draw_damper_changes, draw_sensor_changes, draw_skewed_logs, draw_delays, draw_limits, draw_seat_changes)
UNTOUCHED = "untouched"
"""In place of an effect: the carrier as it was measured, which shows what is named without any effect put in."""
_LEAST_RUNS = 3
"""Of a case from which on one is withheld, to compare the claimed with the true shrink."""


class DrawnCase(NamedTuple):
    """A carrier with an effect in it, and what is true of that."""

    change: Change
    altered: Altered
    size: float
    """Of the change, in standard deviations of the channel that it moves most."""


def draw_changes(carrier: Carrier, rng: Generator) -> list[Change]:
    """Return every change of the signals that a carrier allows, with what is random about each drawn.

    Header and nominal are those of the carrier in every case, so that they do not tell what was done.
    """
    return [change for draw in _DRAWERS for change in draw(carrier, rng)]


def choose_runs(carrier: Carrier, rng: Generator) -> Carrier:
    """Return the carrier with at most `_MOST_RUNS` of its runs, drawn and in their own order."""
    names = list(carrier.tables)
    kept = sorted(rng.choice(len(names), min(_MOST_RUNS, len(names)), replace=False))
    return dataclasses.replace(carrier, tables={names[k]: carrier.tables[names[k]] for k in kept})


def draw_amount(ruler: Ruler, change: Change, size: float) -> DrawnCase | None:
    """Return the change at the amount at which it has a size, None where no amount that it permits has about that."""
    low, high = 0.0, change.largest
    for _ in range(_EVALUATIONS):
        middle = 0.5 * (low + high) if low > 0.0 else 0.25 * high
        found = ruler.size(change.alter(middle).carrier)
        if abs(found - size) < _CLOSE * size:
            break
        low, high = (middle, high) if found < size else (low, middle)
    altered = change.alter(middle)
    found = ruler.size(altered.carrier)
    fits = 1.0 - 2.0 * _CLOSE < found / size < 1.0 + 4.0 * _CLOSE and ruler.stands_out(altered.carrier)
    return DrawnCase(change, altered, found) if fits else None


def make_on_carrier(
    recording: str | Path,
    cases: int,
    seed: int | None,
    out: str | Path,
    sealed: str | Path,
    progress: Progress | None = None,
    processes: int = 2,
) -> str:
    """Write a set on a recording, as `make_set` does; return the key.

    The effects that the recording allows take turns, and beside them the recording as it is.

    Raises:
        InputError: the recording is none, allows no effect of a material size, or the folder is another set's.
    """
    source = Path(recording)
    carrier = read_carrier(source)

    def order(seed: int) -> list[str]:
        return take_turns(carrier, cases, np.random.default_rng(seed))

    kinds, draw = f"carrier {source.resolve()}", functools.partial(_draw_files, source)
    return make_set(cases, seed, kinds, Path(out), Path(sealed), order, draw, progress, processes)


def take_turns(carrier: Carrier, cases: int, rng: Generator) -> list[str]:
    """Return the effect that each case is to have: all that the carrier allows, in a new order every time."""
    effects = [*sorted({change.effect for change in draw_changes(carrier, rng)}), UNTOUCHED]
    turns = [effects[k] for _ in range(-(-cases // len(effects))) for k in rng.permutation(len(effects))]
    return turns[:cases]


def _draw_files(source: Path, wanted: str, rng: Generator) -> CaseFiles:
    """Draw a case on the recording in a folder, of which the last run is withheld where there are enough.

    Raises:
        InputError: no effect of a material size can be put into the carrier.
    """
    carrier = choose_runs(read_carrier(source), rng)
    drawn = None if wanted == UNTOUCHED else _draw_case(carrier, wanted, rng)
    told = carrier if drawn is None else drawn.altered.carrier
    runs = tuple(told.tables)
    withheld = runs[-1:] if len(runs) >= _LEAST_RUNS else ()
    shown = encode_carrier(told, tuple(run for run in runs if run not in withheld))
    return CaseFiles(shown, encode_carrier(told, withheld) if withheld else {}, label(drawn))


def _draw_case(carrier: Carrier, wanted: str, rng: Generator) -> DrawnCase:
    """Return the wanted effect at a drawn size, or another where the carrier allows no such size of it.

    Raises:
        InputError: no effect of a material size can be put into the carrier.
    """
    # log-uniform from just material to strong
    ruler, size = Ruler(carrier), float(np.exp(rng.uniform(math.log(_WEAKEST), math.log(_STRONGEST))))
    changes = draw_changes(carrier, rng)
    tried = sorted((changes[k] for k in rng.permutation(len(changes))), key=lambda change: change.effect != wanted)
    for change in tried:
        drawn = draw_amount(ruler, change, size)
        if drawn is not None:
            return drawn
    raise InputError(f"no effect can be put in at {size:.2f} std; record other channels, or identify the nominal anew")


def label(drawn: DrawnCase | None) -> Label:
    """Return what is true of a case."""
    if drawn is None:
        return {"kind": "untouched", "effects": [], "blocks": []}
    change = drawn.change
    return {
        "kind": "carried",
        "effects": [change.effect],
        "blocks": [change.effect.partition(".")[0]],
        "forms": [change.form],
        "materialities": [drawn.size / MATERIAL_SHARE],
        "shapes": [dict(drawn.altered.parameters)],
        "faulty_channels": [change.channel] if change.channel else [],
    }
