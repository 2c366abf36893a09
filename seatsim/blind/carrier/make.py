"""Makes a set of sealed cases on a measured recording.

Every case has its own generator, spawned from the seed, so a set is the same in any order and with any number of
processes, and one that was broken off goes on.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.draw import DrawnCase, choose_runs, draw_amount, draw_size
from seatsim.blind.carrier.injections.catalogue import draw_changes
from seatsim.blind.carrier.recorded import Carrier, encode_carrier, read_carrier
from seatsim.blind.carrier.replays import MATERIAL_SHARE, Ruler
from seatsim.blind.labels import Label
from seatsim.blind.make.folder import write_folder
from seatsim.blind.make.unfinished import begin_or_resume, case_name, gather, is_finished, keep_label, keep_unseen
from seatsim.blind.processes import Progress, run_jobs
from seatsim.blind.sealed import seal
from seatsim.schema.errors import InputError

UNTOUCHED = "untouched"
"""In place of an effect: the carrier as it was measured, which shows what is named without any effect put in."""
LEAST_RUNS = 3
"""Of a case from which on one is withheld, to compare the claimed with the true shrink."""


def make_on_carrier(
    recording: str | Path, cases: int, seed: int | None, out: str | Path, sealed: str | Path,
    progress: Progress | None = None, processes: int = 2,
) -> str:  # fmt: skip
    """Write DIR/case-0001/... and the sealed file; return the key, which is stored nowhere.

    The effects that the recording allows take turns, and beside them the recording as it is. Without `seed` one is
    drawn and sealed; `progress` is called with the cases done and all cases.

    Raises:
        InputError: the recording is none, allows no effect of a material size, or the folder is another set's.
    """
    folder, target, source = Path(out), Path(sealed), Path(recording)
    partial = target.with_name(f"{target.name}.partial")
    if target.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{target}: lies inside {folder}; the labels must lie elsewhere than the recordings")
    carrier = read_carrier(source)
    state = begin_or_resume(cases, seed, f"carrier {source.resolve()}", folder, target, partial)
    wanted = take_turns(carrier, cases, np.random.default_rng(state["seed"]))
    todo = [k for k in range(cases) if not is_finished(folder, partial, case_name(k))]
    done_before = cases - len(todo)
    if progress:
        progress(done_before, cases)
    jobs = [(k, wanted[k], source, state["seed"], folder, partial) for k in todo]
    run_jobs(make_case, jobs, processes, progress and (lambda done, _: progress(done_before + done, cases)))
    seal(target, folder, state["key"], gather(state, partial))
    shutil.rmtree(partial)
    return state["key"]


def take_turns(carrier: Carrier, cases: int, rng: Generator) -> list[str]:
    """Return the effect that each case is to have: all that the carrier allows, in a new order every time."""
    effects = [*sorted({change.effect for change in draw_changes(carrier, rng)}), UNTOUCHED]
    turns = [effects[k] for _ in range(-(-cases // len(effects))) for k in rng.permutation(len(effects))]
    return turns[:cases]


def make_case(k: int, wanted: str, source: Path, seed: int, folder: Path, partial: Path) -> None:
    """Draw the case with index k of a set and write its recording, its unseen run and, last, its label.

    Raises:
        InputError: no effect of a material size can be put into the carrier.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, k)))
    carrier = choose_runs(read_carrier(source), rng)
    drawn = None if wanted == UNTOUCHED else draw_case(carrier, wanted, rng)
    told = carrier if drawn is None else drawn.altered.carrier
    runs = tuple(told.tables)
    withheld = runs[-1:] if len(runs) >= LEAST_RUNS else ()
    name = case_name(k)
    keep_unseen(partial, name, encode_carrier(told, withheld) if withheld else {})
    if (folder / name).is_dir():
        shutil.rmtree(folder / name)
    write_folder(folder / name, encode_carrier(told, tuple(run for run in runs if run not in withheld)))
    keep_label(partial, name, label(drawn))


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
