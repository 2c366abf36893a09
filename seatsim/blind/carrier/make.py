"""Makes a set of sealed cases on a measured recording: some of its runs, one change of a drawn size in each.

A size is how far a change moves what a gap compares, beyond what parameters inside their tolerance could take away.
"""

import dataclasses
import functools
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.carrier import readings, recorded
from seatsim.blind.carrier.recorded import Altered, Carrier, Change, Content, number, section
from seatsim.blind.carrier.seat import draw_seat_changes
from seatsim.blind.make.make import CaseFiles, encode_yaml, make_set
from seatsim.blind.make.materiality import MATERIAL_SHARE, refit_residuals, rms
from seatsim.blind.sealed import Label
from seatsim.recordings.recording import HEADER, Recording, load_recording
from seatsim.recordings.replay import replay_table, select_compared, stands_out
from seatsim.scenario.loading import single
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.processes import Progress

_WEAKEST, _STRONGEST = 0.06, 0.3
"""Standard deviations of a compared channel by which a change moves it: just material, and strong."""
_MOST_RUNS = 6
"""Of a case, one of which may be withheld: a diagnosis is to take seconds."""
_CLOSE = 0.1
"""Relative difference of a size from the one drawn that is close enough."""
_EVALUATIONS = 12
_READINGS = (readings.draw_sensor_changes, readings.draw_skewed_logs, readings.draw_delays, readings.draw_limits)
_DRAWERS = (readings.draw_damper_changes, *_READINGS, draw_seat_changes)
UNTOUCHED = "untouched"
"""In place of an effect: the carrier as it was measured, which shows what is named without any effect put in."""
_LEAST_RUNS = 3
"""Of a case from which on one is withheld, to compare the claimed with the true shrink."""
_UNKNOWN_TOLERANCE = 0.05
"""Stands for a `parameter_tolerance` that is no single number."""
_ZERO_SCALES = {"f0": 100.0, "fc_a": 100.0, "alpha_a": 100.0}
"""Scales of parameters known to be zero (contract, section 3), N."""
_EXACT = ("n", "x0", "v_ref")
"""Parameters of a damper that are exponents, lengths or regularisations: known."""
_OWN_SHARE = 0.5
"""Of a change's own square by which it must at least raise that of the residuals."""
_Residuals = dict[str, Array]
"""Measured minus simulated by compared channel, over all runs, shape (N,) each."""


class Ruler:
    """Measures changes of one carrier; the sensitivities to its parameters are computed once."""

    def __init__(self, carrier: Carrier) -> None:
        self.carrier = carrier
        self.recording = _load(carrier)
        self.before = self.residuals(carrier)
        self.spread = {name: float(np.std(carrier.pooled(name))) for name in self.before}
        moved = [self._change(carrier._replace(nominal=nominal)) for nominal in _varied_nominals(carrier)]
        # how the residuals change where each parameter is up by its tolerance, in std, end to end
        self.columns = [column for column in moved if np.all(np.isfinite(column))]

    def size(self, changed: Carrier) -> float:
        """Return the largest change of a compared channel in its std, after the best refit inside the tolerance.

        `max_c rms(g - J theta)_c`, `|theta| <= 1`, where g is what the change does to measured minus simulated. A
        change below a channel's noise counts as none there.
        """
        g = self._change(changed)
        if not np.all(np.isfinite(g)):
            return float("inf")
        parts = dict(zip(self.before, np.split(refit_residuals(self.columns, g), len(self.before)), strict=True))
        sizes = {name: rms(values) for name, values in parts.items()}
        return max((r for name, r in sizes.items() if r > self.carrier.noise(name) / self.spread[name]), default=0.0)

    def stands_out(self, changed: Carrier) -> bool:
        """Tell whether a change adds to the gap about what it does by itself, so that taking it away would help.

        Where the background holds the opposite of the effect the two cancel, and nobody can know which is true:
        `|r1|^2 - |r0|^2 >= _OWN_SHARE |g|^2` of the residuals before and after, each refitted inside the tolerance.
        """
        g = self._change(changed)
        r0 = np.concatenate([values / self.spread[name] for name, values in self.before.items()])
        before, after, own = (refit_residuals(self.columns, values) for values in (r0, r0 + g, g))
        return bool(after @ after - before @ before >= _OWN_SHARE * (own @ own))

    def _change(self, changed: Carrier) -> Array:
        """Return what a change does to measured minus simulated, in std, end to end; NaN where channels are lost."""
        after = self.residuals(changed)
        if set(after) != set(self.before):
            return np.full(sum(map(len, self.before.values())), np.nan)
        return np.concatenate([(after[name] - self.before[name]) / self.spread[name] for name in self.before])

    def residuals(self, carrier: Carrier) -> _Residuals:
        """Return measured minus simulated of the channels that stand above their noise."""
        scenario, rate = single(carrier.nominal), self.recording.header.sample_rate
        parts: dict[str, list[Array]] = {}
        for table in carrier.tables.values():
            measured = select_compared(table, carrier.rig, rate)
            for name, values in replay_table(scenario, self.recording, table).items():
                parts.setdefault(name, []).append(measured[name] - values)
        pooled = {name: np.concatenate(values) for name, values in parts.items()}
        return {n: values for n, values in pooled.items() if stands_out(carrier.pooled(n), carrier.noise(n))}


def _load(carrier: Carrier) -> Recording:
    """Return the header of a carrier, whose displacement is interpolated in the replay of a bench.

    Smoothing it would take much longer, and a size needs none.
    """
    with temporary_folder() as folder:
        header = {**carrier.header, "nominal": "nominal.yaml"}
        (folder / HEADER).write_bytes(encode_yaml(header))
        (folder / "nominal.yaml").write_bytes(encode_yaml(carrier.nominal))
        recording = load_recording(folder)
    smooth = {
        name: entry._replace(noise_rms=0.0) for name, entry in recording.channels.items() if name == "displacement"
    }
    return dataclasses.replace(recording, channels=recording.channels | smooth)


def _varied_nominals(carrier: Carrier) -> list[Content]:
    """Return the nominal with each of its parameters, one after another, up by the tolerance."""
    stated, nominal = carrier.header.get("parameter_tolerance", 0.02), carrier.nominal
    share = number(stated) if isinstance(stated, int | float) else _UNKNOWN_TOLERANCE
    damper, plant, coil = section(nominal, "damper"), section(nominal, "plant"), section(nominal, "actuator")
    values = section(damper, "parameters")
    varied: list[Content] = []
    for key, value in values.items():
        step = share * (number(value) or _ZERO_SCALES.get(key, 0.0))
        if key not in _EXACT and step and np.isfinite(step):
            varied.append({**nominal, "damper": {**damper, "parameters": {**values, key: number(value) + step}}})
    for name, part in (("plant", plant), ("actuator", coil)):
        for key, value in part.items():
            if key != "max_current" and share * (number(value) or 0.0) > 0.0:
                varied.append({**nominal, name: {**part, key: number(value) * (1.0 + share)}})
    return varied


class _DrawnCase(NamedTuple):
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


def _choose_runs(carrier: Carrier, rng: Generator) -> Carrier:
    """Return the carrier with at most `_MOST_RUNS` of its runs, drawn and in their own order."""
    names = list(carrier.tables)
    kept = sorted(rng.choice(len(names), min(_MOST_RUNS, len(names)), replace=False))
    return carrier._replace(tables={names[k]: carrier.tables[names[k]] for k in kept})


def draw_amount(ruler: Ruler, change: Change, size: float) -> _DrawnCase | None:
    """Return the change at the amount at which it has a size, None where no amount that it permits has about that."""
    low, high = 0.0, change.largest
    for _ in range(_EVALUATIONS):
        middle = 0.5 * (low + high) if low > 0.0 else 0.25 * high
        altered = change.alter(middle)
        found = ruler.size(altered.carrier)
        if abs(found - size) < _CLOSE * size:
            break
        low, high = (middle, high) if found < size else (low, middle)
    fits = 1.0 - 2.0 * _CLOSE < found / size < 1.0 + 4.0 * _CLOSE and ruler.stands_out(altered.carrier)
    return _DrawnCase(change, altered, found) if fits else None


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
    order = functools.partial(_take_turns, recorded.read_carrier(source), cases)
    kinds, draw = f"carrier {source.resolve()}", functools.partial(_draw_files, source)
    return make_set(cases, seed, kinds, Path(out), Path(sealed), order, draw, progress, processes)


def _take_turns(carrier: Carrier, cases: int, seed: int) -> list[str]:
    """Return the effect that each case is to have: all that the carrier allows, in a new order every time."""
    rng = np.random.default_rng(seed)
    effects = [*sorted({change.effect for change in draw_changes(carrier, rng)}), UNTOUCHED]
    turns = [effects[k] for _ in range(-(-cases // len(effects))) for k in rng.permutation(len(effects))]
    return turns[:cases]


def _draw_files(source: Path, wanted: str, rng: Generator) -> CaseFiles:
    """Draw a case on the recording in a folder, of which the last run is withheld where there are enough.

    Raises:
        InputError: no effect of a material size can be put into the carrier.
    """
    carrier = _choose_runs(recorded.read_carrier(source), rng)
    drawn = None if wanted == UNTOUCHED else _draw_case(carrier, wanted, rng)
    told = carrier if drawn is None else drawn.altered.carrier
    runs = tuple(told.tables)
    withheld = runs[-1:] if len(runs) >= _LEAST_RUNS else ()
    shown = recorded.encode_carrier(told, tuple(run for run in runs if run not in withheld))
    return CaseFiles(shown, recorded.encode_carrier(told, withheld) if withheld else {}, label(drawn))


def _draw_case(carrier: Carrier, wanted: str, rng: Generator) -> _DrawnCase:
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


def label(drawn: _DrawnCase | None) -> Label:
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
