"""How strong an effect is: by how much it moves the channels that a gap compares, and the severity that does so.

Materiality (contract, section 4): the largest over compared channels of `rms(moved) / max(0.05 std, noise)`; 1 is the
material limit. What is moved is what a replay would miss: the reading with the effect less the reading without it, and
less what the faulty inputs already move in the replay.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.case import Setting, drive, read
from seatsim.blind.truth.rig import RATE, Motion
from seatsim.blind.truth.slots import Array
from seatsim.blind.truth.truth import Changes

SHARE = 0.05
TOLERANCE = 0.2
"""Of the logarithm of a materiality."""
COARSE = 2.5e-4
"""Step of the simulations that only measure sizes, s."""
Readings = list[dict[str, Array]]


@dataclass
class Bench:
    """The recorded runs of a setting under fixed commands; motions are kept by what moves them."""

    setting: Setting
    commands: list[Array]
    kept: dict[str, list[Motion]] = field(default_factory=dict)

    @property
    def runs(self) -> range:
        """Recorded runs."""
        return range(len(self.commands))

    def motions(self, changes: Changes) -> list[Motion]:
        """Return the motion of each run, simulated once."""
        key = repr((sorted(changes.slots.items()), changes.pushes))
        if key not in self.kept:
            if len(self.kept) > 6:
                self.kept.pop(list(self.kept)[1])
            self.kept[key] = [drive(self.setting, changes, k, self.commands[k], step=COARSE) for k in self.runs]
        return self.kept[key]

    def shown(self, changes: Changes) -> Readings:
        """Return what the channels show in each run."""
        motions = self.motions(changes)
        return [read(self.setting, changes, k, motions[k]) for k in self.runs]

    def moved(self, effect: Changes, others: Changes) -> tuple[float, Array]:
        """Return the materiality of an effect in the presence of others, and its signature over channels and runs."""
        changes, scales = self.change(effect, others)
        if not changes or not all(np.all(np.isfinite(change)) for change in changes.values()):
            return math.inf, np.zeros(1)
        parts = [change / scales[name] for name, change in changes.items()]
        return max(rms(part) for part in parts), np.concatenate(parts)

    def change(self, effect: Changes, others: Changes) -> tuple[dict[str, Array], dict[str, float]]:
        """Return what a replay would miss by compared channel (the loud ones), and the material limit of each."""
        both = self.shown(others + effect)
        rest = self.shown(others)
        driven = self._through_inputs(effect, others, both) if any(f.on_input for f in effect.faults) else None
        changes: dict[str, Array] = {}
        scales: dict[str, float] = {}
        skip = round(RATE)
        for name in self.setting.compared:
            with_it = np.concatenate([run[name][skip:] for run in both])
            spread, noise = float(np.std(with_it)), self.setting.noise[name]
            if spread < 3.0 * noise:
                continue
            changes[name] = with_it - np.concatenate([run[name][skip:] for run in rest])
            if driven is not None:
                changes[name] -= driven[name]
            scales[name] = max(SHARE * spread, noise)
        return changes, scales

    def _through_inputs(self, effect: Changes, others: Changes, shown: Readings) -> dict[str, Array]:
        """Return what faulty inputs move in a replay, by compared channel."""
        base = self.motions(Changes(others.slots, others.pushes))
        clean = Changes(others.slots, others.pushes)
        on_floor = any(f.channel == "floor_acceleration" for f in effect.faults)
        skip = round(RATE)
        total: dict[str, list[Array]] = {name: [] for name in self.setting.compared}
        for k in self.runs:
            floor = shown[k]["floor_acceleration"] if on_floor else None
            motion = drive(self.setting, clean, k, shown[k]["current_command"], floor, COARSE)
            new, old = read(self.setting, clean, k, motion), read(self.setting, clean, k, base[k])
            for name, parts in total.items():
                parts.append(new[name][skip:] - old[name][skip:])
        return {name: np.concatenate(parts) for name, parts in total.items()}


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def overlap(a: Array, b: Array) -> float:
    """Return the absolute correlation of two signatures."""
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return abs(float(a @ b)) / size if size else 0.0


def target_size(rng: Generator, top: float = 8.0, bottom: float = 1.1) -> float:
    """Draw a materiality, log-uniform from the material limit to strong."""
    return float(np.exp(rng.uniform(math.log(bottom), math.log(max(top, bottom * 1.01)))))


def severity_for(
    size_of: Callable[[float], float], span: tuple[float, float], rng: Generator
) -> tuple[float, float] | None:
    """Return severity and materiality near a drawn target, or None where nothing plausible is material.

    Secant steps in the logarithms between bounds that close in; a form too weak for the target gets a new, lower one.
    """
    target = target_size(rng)
    low, high = span
    known: list[tuple[float, float]] = []
    s = min(max(1.0, low), high)
    for _ in range(9):
        size = size_of(s)
        if not math.isfinite(size):
            high = 0.6 * s
            s = math.sqrt(max(low, s / 8.0) * high)
            if high <= low:
                return None
            continue
        known.append((s, size))
        if abs(math.log(max(size, 1e-9) / target)) < TOLERANCE:
            break
        if size < target and s >= high * 0.999:
            if size < 1.15:
                return None
            target = target_size(rng, size)
            continue_from = s * (target / size)
            s = min(max(continue_from, low), high)
            if s >= high * 0.999:
                break
            continue
        s = _next(known, target, low, high)
    good = [pair for pair in known if pair[1] >= 1.03]
    if not good:
        return None
    return min(good, key=lambda pair: abs(math.log(pair[1] / target)))


def _next(known: list[tuple[float, float]], target: float, low: float, high: float) -> float:
    """Return the next severity: between the closest below and above, else on from the closest."""
    below = [pair for pair in known if pair[1] < target]
    above = [pair for pair in known if pair[1] >= target]
    if below and above:
        (s0, m0), (s1, m1) = max(below, key=lambda pair: pair[1]), min(above, key=lambda pair: pair[1])
        share = math.log(target / max(m0, 1e-9)) / math.log(m1 / max(m0, 1e-9))
        return float(math.exp(math.log(s0) + min(max(share, 0.1), 0.9) * math.log(s1 / s0)))
    s, size = (below or above)[-1]
    return float(min(max(s * min(max(target / max(size, 1e-9), 0.1), 6.0), low), high))
