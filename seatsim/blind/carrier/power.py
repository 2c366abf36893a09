"""The power of a diagnosis on a rig: for each effect, how small it may be and still be found in nine of ten draws."""

from __future__ import annotations

import hashlib
import math
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier.make import DrawnCase, choose_runs, draw_amount, draw_changes, label
from seatsim.blind.carrier.readings import draw_faster_coils
from seatsim.blind.carrier.recorded import Carrier, Change, encode_carrier, read_carrier
from seatsim.blind.carrier.replays import Ruler
from seatsim.blind.make.folder import write_folder
from seatsim.blind.score.verdicts import is_right, read_verdict
from seatsim.schema.content import Unwritten, written
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.files import write_json, write_text
from seatsim.schema.guarded import expect, read_json
from seatsim.schema.processes import run_jobs

SIZES = (0.06, 0.1, 0.16, 0.25, 0.4)
"""Standard deviations by which the effect moves a compared channel: from just material to more than strong."""
_FOUND_SHARE = 0.9
_BATCH = 4
"""Draws that are begun before those missed are counted."""
_Diagnose = Callable[[Path], None]
"""Writes CASE/diagnosis/diagnosis.json; it must be picklable."""


class Trial(NamedTuple):
    """One draw: what was put in, None where the recording does not allow that size, and whether it was found."""

    parameters: Mapping[str, float] | None
    found: bool


class _Setting(NamedTuple):
    """What the trials of an effect have in common; it is picklable, for other processes."""

    recording: Path
    out: Path
    diagnose: _Diagnose
    effect: str
    seed: int


class Power(NamedTuple):
    """Of an effect: the smallest size that is found, None where none is, and the trials at each size looked at."""

    effect: str
    smallest: float | None
    trials: Unwritten[dict[float, list[Trial]]]

    @property
    @written()
    def parameters(self) -> dict[str, float]:
        """Return the mean size of the effect's parameters at the smallest size that is found."""
        trials = [] if self.smallest is None else self.trials[self.smallest]
        put_in = [trial.parameters for trial in trials if trial.parameters is not None]
        names = sorted(set.intersection(*(set(parameters) for parameters in put_in))) if put_in else []
        return {name: float(np.mean([abs(parameters[name]) for parameters in put_in])) for name in names}

    @property
    @written()
    def found(self) -> dict[str, list[bool]]:
        """Whether each draw that the recording allowed was found, by its size."""
        return {
            f"{size:g}": [trial.found for trial in trials if trial.parameters is not None]
            for size, trials in self.trials.items()
        }


class Powers(NamedTuple):
    """The smallest sizes found, of so many draws at each: the content of `power.json`."""

    draws: int
    effects: list[Power]


def measure_power(
    recording: Path,
    out: Path,
    diagnose: _Diagnose,
    effects: Sequence[str] = (),
    draws: int = 10,
    seed: int = 0,
    processes: int = 2,
    progress: Callable[[Power, int, int], None] | None = None,
) -> list[Power]:
    """Return the power for each effect that a recording allows, or for those named, by bisection over SIZES.

    A size is given up once more draws are missed than a tenth. Every case stays in `out`/cases with its diagnosis, so
    that a call broken off goes on; `progress` is called after each effect with it, those done and all.

    Raises:
        InputError: the recording is none, or does not allow an effect that is named.
    """
    possible = sorted({change.effect for change in _draw_all(read_carrier(recording), np.random.default_rng(seed))})
    for name in effects:
        if name not in possible:
            permitted = f"{nearest(name, possible)}; this recording allows {', '.join(possible)}"
            raise InputError(f"{recording}: '{name}' cannot be put in{permitted}")
    _begin(recording, out, seed)
    found: list[Power] = []
    chosen = list(effects) or possible
    for effect in chosen:
        setting = _Setting(recording, out, diagnose, effect, seed)
        found.append(_bisect(setting, draws, processes))
        if progress:
            progress(found[-1], len(found), len(chosen))
    return found


def _draw_all(carrier: Carrier, rng: Generator) -> list[Change]:
    return draw_changes(carrier, rng) + draw_faster_coils(carrier, rng)


def _bisect(setting: _Setting, draws: int, processes: int) -> Power:
    """Return the smallest size that is found, taking what is found at one size to be found at every larger one.

    Where a size is more than the recording allows, smaller ones are looked at.
    """
    low, high, smallest = -1, len(SIZES), None
    trials: dict[float, list[Trial]] = {}
    while high - low > 1:
        middle = (low + high) // 2
        size = SIZES[middle]
        trials[size] = _try_size(setting, size, draws, processes)
        found = sum(trial.found for trial in trials[size]) >= math.ceil(_FOUND_SHARE * draws)
        too_large = all(trial.parameters is None for trial in trials[size])
        smallest = size if found else smallest
        low, high = (low, middle) if found or too_large else (middle, high)
    return Power(setting.effect, smallest, dict(sorted(trials.items())))


def _try_size(setting: _Setting, size: float, draws: int, processes: int) -> list[Trial]:
    """Return the trials at a size, fewer than asked for where so many are missed already that it is not found."""
    trials: list[Trial] = []
    allowed = draws - math.ceil(_FOUND_SHARE * draws)
    for first in range(0, draws, _BATCH):
        batch = range(first, min(first + _BATCH, draws))
        trials += run_jobs(_try_draw, [(setting, size, k) for k in batch], processes)
        if sum(not trial.found for trial in trials) > allowed:
            break
    return trials


def _try_draw(setting: _Setting, size: float, draw: int) -> Trial:
    """Return one trial, read from its file where it was made before."""
    name = f"{setting.effect}-{size:g}-{draw + 1:02d}"
    case, note = setting.out / "cases" / name, setting.out / "cases" / f"{name}.json"
    if note.is_file():
        with expect(note, "trial; remove it, and it is made again"):
            known = cast("dict[str, Any]", read_json(note, "trial"))
            return Trial(known["parameters"], bool(known["found"]))
    drawn = _draw(setting, size, draw)
    trial = Trial(None, False) if drawn is None else _diagnosed(setting, case, drawn)
    write_json(note, trial._asdict())
    return trial


def _draw(setting: _Setting, size: float, draw: int) -> DrawnCase | None:
    rng = np.random.default_rng([setting.seed, draw])
    carrier = choose_runs(read_carrier(setting.recording), rng)
    changes = [change for change in _draw_all(carrier, rng) if change.effect == setting.effect]
    ruler, order = Ruler(carrier), rng.permutation(len(changes))
    return next((drawn for k in order if (drawn := draw_amount(ruler, changes[k], size)) is not None), None)


def _diagnosed(setting: _Setting, case: Path, drawn: DrawnCase) -> Trial:
    if case.is_dir():
        shutil.rmtree(case)
    carrier = drawn.altered.carrier
    write_folder(case, encode_carrier(carrier, tuple(carrier.tables)))
    setting.diagnose(case)
    said = read_verdict(case / "diagnosis" / "diagnosis.json")
    return Trial(drawn.altered.parameters, is_right(label(drawn), said))


def _begin(recording: Path, out: Path, seed: int) -> None:
    """Note what the folder belongs to, so that cases of another recording are not taken for this one's."""
    digest = hashlib.sha256(str(seed).encode())
    for path in sorted(path for path in recording.iterdir() if path.is_file()):
        digest.update(path.read_bytes())
    note = out / "cases" / "made-of.txt"
    if note.is_file() and note.read_text(encoding="utf-8") != digest.hexdigest():
        raise InputError(f"{out}: holds cases of another recording or seed; delete it, or give another --out")
    write_text(note, digest.hexdigest())
