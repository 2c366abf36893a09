"""A scenario's effects, put where they act: on plant, coil and damper, in the time loop, on inputs and on readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatsim.effects.base import ON_DAMPER, ON_SEAT, BeforeRun, acts_on, methods_of, off
from seatsim.kernel.augmented import AugmentedDamper
from seatsim.kernel.chain import Effects, state_at_rest
from seatsim.schema.registry import find, names, specification_of

Array = NDArray[np.float64]
NONE = np.zeros(0)


def changed(effects: Sequence[Any], method: BeforeRun, value: Any, *args: Any) -> Any:
    """Return `value` handed through that method of every effect that has it, as its last argument."""
    for change in methods_of(effects, method):
        value = change(*args, value)
    return value


def undone(effects: Sequence[Any], value: Any, channel: str, step: float) -> Any:
    """Return what is true out of what a sensor says: the effects' readings undone, the last one first."""
    return changed(effects[::-1], "truth", value, channel, step)


def in_loop(effects: Sequence[Any]) -> tuple[Effects, Effects]:
    """Return the effects on the damper and on the seat that the time loop is compiled with.

    Where any is at work all registered ones are carried, off where they are not chosen, so that every subset shares
    one compiled loop; where none is, none are.
    """
    if not any(acts_on(type(effect), ON_DAMPER + ON_SEAT) for effect in effects):
        return (), ()
    return _carried(effects, ON_DAMPER), _carried(effects, ON_SEAT)


def _carried(effects: Sequence[Any], hooks: tuple[str, ...]) -> Effects:
    registered = _acting(tuple(find("effect", name) for name in names("effect")), hooks)
    chosen = [effect for effect in effects if acts_on(type(effect), hooks)]
    first = {type(effect): effect for effect in reversed(chosen)}
    carried = [first.get(cls) or off(cls) for cls in registered]
    return tuple(carried + [effect for effect in chosen if not any(effect is kept for kept in carried)])


@cache
def _acting(classes: tuple[Any, ...], hooks: tuple[str, ...]) -> list[Any]:
    """Return the effects that have one of the hooks."""
    return [cls for cls in classes if acts_on(cls, hooks)]


def damper_with(record: Any, effects: Effects) -> tuple[Any, tuple[float, ...]]:
    """Return a damper's record with effects on it, and its state at rest."""
    initial: tuple[float, ...] = specification_of(type(record)).initial
    if not effects:
        return record, initial
    return AugmentedDamper(record, effects), initial + state_at_rest([type(effect) for effect in effects])


def pushes(effects: Sequence[Any], time: Array, seed: int) -> Array:
    """Return the force on the frame in N that effects add, shape (N,), or of length 0 where none does."""
    found = [np.asarray(force(time, seed)) for force in methods_of(effects, "frame_force")]
    return np.sum(found, axis=0) if found else NONE


def readings(effects: Sequence[Any], step: float, true: Mapping[str, Array]) -> dict[str, Array]:
    """Return what the sensors say of true channels that are sampled every `step` seconds, shape (N,) each."""
    return {name: changed(effects, "reading", values, name, step) for name, values in true.items()}
