"""Draws a case: which kind, which effects in which form, how strong, on which rig with which channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.absorbed import Absorption
from seatsim.blind.make.case import CHANNELS, Setting, context_of, draw_setting, drive, read
from seatsim.blind.make.sizing import COARSE, Bench, overlap, severity_for
from seatsim.blind.truth.catalogue import TRUTHS, forms_of
from seatsim.blind.truth.slots import Array
from seatsim.blind.truth.truth import EFFECTS, Changes, Context, Shape, Truth
from seatsim.schema.errors import RunError

KINDS = ("none", "one", "two", "outside")
TRIES = 14
TWINS = 0.9
"""Two effects whose signatures correlate above this are one effect to any diagnoser, and are not drawn together."""
OPTIONAL = ("damper_force", "coil_current", "damper_temperature")


@dataclass(frozen=True)
class Order:
    """What a case shall be: its kind, and the effects (or the outside forms) it shall hold."""

    kind: str
    names: tuple[str, ...] = ()
    missing: tuple[str, ...] | None = None
    background: float = 0.0
    scatter: float = 0.015


@dataclass(frozen=True)
class Placed:
    """A truth form, its drawn shape and severity, its materiality beside the others: in all, and net of tolerance."""

    truth: Truth
    shape: Shape
    severity: float
    materiality: float
    changes: Changes
    net: float = 0.0


@dataclass(frozen=True)
class Case:
    """A drawn case: the rig, what is wrong with it, what its channels show without noise; the last run is unseen."""

    order: Order
    setting: Setting
    placed: tuple[Placed, ...]
    shown: list[dict[str, Array]]
    overlap: float

    def label(self) -> dict[str, object]:
        """Return the label: kind, effects, blocks, and all that was drawn."""
        return {
            "kind": self.order.kind,
            "effects": [p.truth.effect for p in self.placed if not p.truth.outside],
            "blocks": [p.truth.block for p in self.placed],
            "forms": [p.truth.name for p in self.placed],
            "severities": [p.severity for p in self.placed],
            "materialities": [p.materiality for p in self.placed],
            "net_materialities": [p.net for p in self.placed],
            "shapes": [p.shape for p in self.placed],
            "faulty_channels": [f.channel for p in self.placed for f in p.changes.faults],
            "overlap": self.overlap,
            "nominal": "bingham" if self.setting.nominal["is_bingham"] else "bouc_wen",
            "missing": [name for name in CHANNELS if name not in self.setting.channels],
            "temperatures": [run.temperature for run in self.setting.runs],
            "background": self.order.background,
        }


def draw_missing(rng: Generator) -> tuple[str, ...]:
    """Draw the channels that are not recorded: none in 60 % of cases, rarely two."""
    u = rng.random()
    if u < 0.6:
        return ()
    count = 1 if u < 0.93 else 2
    weights = [0.5, 0.2, 0.3]
    return tuple(str(name) for name in rng.choice(OPTIONAL, count, replace=False, p=weights))


def draw_case(order: Order, rng: Generator) -> Case:
    """Draw a case to order; what cannot be made material in these runs is drawn anew.

    Raises:
        RunError: no draw of these effects is material.
    """
    for _ in range(TRIES):
        case = _attempt(order, rng)
        if case is not None:
            return case
    if order.kind in ("one", "two"):
        other = tuple(str(name) for name in rng.choice(EFFECTS, len(order.names), replace=False))
        return draw_case(Order(order.kind, other, order.missing, order.background, order.scatter), rng)
    raise RunError(f"no material case of kind {order.kind} came of {TRIES} draws")


def _truths(order: Order, rng: Generator) -> list[Truth]:
    if order.kind == "outside":
        return [TRUTHS[name] for name in order.names]
    forms = [forms_of(effect) for effect in order.names]
    return [some[int(rng.integers(len(some)))] for some in forms]


def _attempt(order: Order, rng: Generator) -> Case | None:
    truths = _truths(order, rng)
    missing = order.missing if order.missing is not None else draw_missing(rng)
    needed = {name for truth in truths for name in truth.needs}
    channels = tuple(name for name in CHANNELS if name not in missing or name in needed)
    bingham = rng.random() < 0.25 or any(truth.bingham for truth in truths)
    warm = any(truth.warm for truth in truths)
    setting = draw_setting(rng, bingham, channels, warm, order.scatter, order.background)
    recorded = len(setting.runs) - 1
    plain = [drive(setting, Changes(), k, step=COARSE) for k in range(recorded)]
    bench = Bench(setting, [motion.command for motion in plain])
    context = context_of(setting, [read(setting, Changes(), k, plain[k]) for k in range(recorded)])
    first: list[Placed] = []
    for truth in truths:
        shape = truth.draw(rng, context)
        found = severity_for(_size_alone(bench, truth, shape, context), truth.span, rng)
        if found is None:
            return None
        first.append(Placed(truth, shape, found[0], found[1], truth.build(found[0], shape, context)))
    absorption = Absorption(setting, bench.commands) if first else None
    return _settled(order, setting, first, context, absorption)


def _size_alone(bench: Bench, truth: Truth, shape: Shape, context: Context) -> Callable[[float], float]:
    return lambda severity: bench.moved(truth.build(severity, shape, context), Changes())[0]


def _settled(
    order: Order, setting: Setting, placed: list[Placed], context: Context, absorption: Absorption | None = None
) -> Case | None:
    """Close the loop with the effects in it; raise what is no longer material beside the others, or give up."""
    recorded = len(setting.runs) - 1
    for _ in range(6):
        total = sum((p.changes for p in placed), Changes())
        motions = [drive(setting, total, k) for k in range(recorded + 1)]
        if not all(np.all(np.isfinite(motion.frame)) for motion in motions):
            return None
        bench = Bench(setting, [motion.command for motion in motions[:recorded]])
        sizes, nets, signatures = [], [], []
        for k in range(len(placed)):
            others = sum((p.changes for j, p in enumerate(placed) if j != k), Changes())
            size, signature = bench.moved(placed[k].changes, others)
            sizes.append(size)
            nets.append(size * absorption.share_left(placed[k].changes, others) if absorption else size)
            signatures.append(signature)
        alike = overlap(*signatures) if len(signatures) == 2 else 0.0
        if alike > TWINS or any(not np.isfinite(size) for size in sizes):
            return None
        if all(net >= 1.02 for net in nets):
            done = tuple(replace(p, materiality=m, net=n) for p, m, n in zip(placed, sizes, nets, strict=True))
            shown = [read(setting, total, k, motion) for k, motion in enumerate(motions)]
            return Case(order, setting, done, shown, alike)
        placed = [_raised(p, size, context) for p, size in zip(placed, nets, strict=True)]
    return None


def _raised(placed: Placed, size: float, context: Context) -> Placed:
    if size >= 1.02:
        return placed
    stronger = min(placed.severity * 1.15 / max(size, 0.4), placed.truth.span[1])
    return Placed(placed.truth, placed.shape, stronger, size, placed.truth.build(stronger, placed.shape, context))
