"""Makes a set of sealed cases on a measured recording."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.draw import DrawnCase, choose_runs, draw_amount, draw_size
from seatsim.blind.carrier.injections.catalogue import draw_changes
from seatsim.blind.carrier.recorded import Carrier, encode_carrier, read_carrier
from seatsim.blind.carrier.replays import MATERIAL_SHARE, Ruler
from seatsim.blind.labels import Label
from seatsim.blind.make.make import CaseFiles, make_set
from seatsim.schema.errors import InputError
from seatsim.schema.processes import Progress

UNTOUCHED = "untouched"
"""In place of an effect: the carrier as it was measured, which shows what is named without any effect put in."""
LEAST_RUNS = 3
"""Of a case from which on one is withheld, to compare the claimed with the true shrink."""


def make_on_carrier(
    recording: str | Path, cases: int, seed: int | None, out: str | Path, sealed: str | Path,
    progress: Progress | None = None, processes: int = 2,
) -> str:  # fmt: skip
    """Write a set on a recording, as `make_set` does; return the key.

    The effects that the recording allows take turns, and beside them the recording as it is.

    Raises:
        InputError: the recording is none, allows no effect of a material size, or the folder is another set's.
    """
    source = Path(recording)
    carrier = read_carrier(source)

    def order(seed: int) -> list[str]:
        return take_turns(carrier, cases, np.random.default_rng(seed))

    kinds, draw = f"carrier {source.resolve()}", functools.partial(draw_files, source)
    return make_set(cases, seed, kinds, Path(out), Path(sealed), order, draw, progress, processes)


def take_turns(carrier: Carrier, cases: int, rng: Generator) -> list[str]:
    """Return the effect that each case is to have: all that the carrier allows, in a new order every time."""
    effects = [*sorted({change.effect for change in draw_changes(carrier, rng)}), UNTOUCHED]
    turns = [effects[k] for _ in range(-(-cases // len(effects))) for k in rng.permutation(len(effects))]
    return turns[:cases]


def draw_files(source: Path, wanted: str, rng: Generator) -> CaseFiles:
    """Draw a case on the recording in a folder, of which the last run is withheld where there are enough.

    Raises:
        InputError: no effect of a material size can be put into the carrier.
    """
    carrier = choose_runs(read_carrier(source), rng)
    drawn = None if wanted == UNTOUCHED else draw_case(carrier, wanted, rng)
    told = carrier if drawn is None else drawn.altered.carrier
    runs = tuple(told.tables)
    withheld = runs[-1:] if len(runs) >= LEAST_RUNS else ()
    shown = encode_carrier(told, tuple(run for run in runs if run not in withheld))
    return CaseFiles(shown, encode_carrier(told, withheld) if withheld else {}, label(drawn))


def draw_case(carrier: Carrier, wanted: str, rng: Generator) -> DrawnCase:
    """Return the wanted effect at a drawn size, or another where the carrier allows no such size of it.

    Raises:
        InputError: no effect of a material size can be put into the carrier.
    """
    ruler, size = Ruler(carrier), draw_size(rng)
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
    channels: Sequence[str] = [change.channel] if change.channel else []
    return {
        "kind": "carried", "effects": [change.effect], "blocks": [change.effect.partition(".")[0]],
        "forms": [change.form], "materialities": [drawn.size / MATERIAL_SHARE],
        "shapes": [dict(drawn.altered.parameters)], "faulty_channels": list(channels),
    }  # fmt: skip
