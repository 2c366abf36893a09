"""A scenario's effects, put where they act: on plant, coil and damper, in the time loop, on inputs and on readings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any, TypeVar

import numpy as np

from seatsim.effects.base import EFFECTS, ON_DAMPER, ON_SEAT, acts_on, off
from seatsim.kernel.augmented import AugmentedDamper
from seatsim.kernel.generic import DamperModel
from seatsim.kernel.hooks import Effects, state_at_rest
from seatsim.kernel.rig import MASSES, SeatedBody
from seatsim.rig.coil import Coil
from seatsim.rig.drivers import BODIES, SINGLE_MASS, Driver, body_matrices
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.arrays import Array, require_samples
from seatsim.schema.errors import InputError
from seatsim.schema.registry import specification_of

_T = TypeVar("_T")

_NONE = np.zeros(0)


def augment_plant(effects: Sequence[object], plant: Plant) -> Plant:
    """Return the parameters of the seat as the effects leave them."""
    return _change(effects, "plant", plant)


def augment_coil(effects: Sequence[object], coil: Coil) -> Coil:
    """Return the parameters of the coil as the effects leave them."""
    return _change(effects, "coil", coil)


def augment_factors(effects: Sequence[object], factors: TemperatureFactors) -> TemperatureFactors:
    """Return the temperature factors of the damper as the effects leave them."""
    return _change(effects, "factors", factors)


def augment_temperature(effects: Sequence[object], step: float, temperature: Array) -> Array:
    """Return the temperature of the fluid in degC out of that of the thermocouple, shape (N,), every `step` seconds."""
    for effect, change in _with(effects, "temperature"):
        temperature = _checked(effect, "temperature", change(step, temperature), temperature, step)
    return temperature


def undo_reading(effects: Sequence[object], values: Array, channel: str, step: float) -> Array:
    """Return what is true out of what a sensor says, shape (N,): the effects on it undone, the last one first."""
    for effect, undo in _with(effects[::-1], "truth"):
        values = _checked(effect, f"truth of {channel}", undo(channel, step, values), values, step)
    return values


def read_sensors(effects: Sequence[object], step: float, true: Mapping[str, Array]) -> dict[str, Array]:
    """Return what the sensors say of true channels that are sampled every `step` seconds, shape (N,) each."""
    found = dict(true)
    for effect, read in _with(effects, "reading"):
        for name, values in found.items():
            found[name] = _checked(effect, f"reading of {name}", read(name, step, values), values, step)
    return found


def sum_frame_forces(effects: Sequence[object], time: Array, seed: int) -> Array:
    """Return the force on the frame in N that effects add, shape (N,), or of length 0 where none does."""
    step = float(time[1]) if len(time) > 1 else 0.0
    pushing = _with(effects, "frame_force")
    forces = [_checked(effect, "frame_force", push(time, seed), time, step) for effect, push in pushing]
    return np.asarray(np.sum(forces, axis=0)) if forces else _NONE


def acts_on_signals(effects: Sequence[object]) -> bool:
    """Return whether an effect changes what drives a run, sample by sample."""
    return any(acts_on(type(effect), ("temperature", "frame_force", "truth")) for effect in effects)


def _with(effects: Sequence[object], hook: str) -> Iterator[tuple[object, Callable[..., Any]]]:
    """Yield the effects that have a method for a hook (see `seatsim.effects.base`), each with it, in their order."""
    # An isinstance of a runtime protocol takes 10 us, some fifty times in a simulation of 10 ms: too slow here.
    return ((effect, getattr(effect, hook)) for effect in effects if hasattr(effect, hook))


def _change(effects: Sequence[object], hook: str, value: _T) -> _T:
    """Return a record as the effects leave it, one after another."""
    for _, change in _with(effects, hook):
        value = change(value)
    return value


def _checked(effect: object, method: str, found: object, like: Array, step: float) -> Array:
    """Return what a method of an effect gives, which must be as many finite samples as in `like`.

    Raises:
        RunError: it is anything else.
    """
    if found is like:
        return like
    giver = f"the {method} of the effect {type(effect).__module__}:{type(effect).__qualname__}"
    return require_samples(found, giver, len(like), step)


def select_in_loop(effects: Sequence[object], carry_all: bool | None = None) -> tuple[Effects, Effects]:
    """Return the effects on the damper and on the seat that the time loop is compiled with.

    With `carry_all` all registered ones are carried, off where they are not chosen, so that every subset shares one
    compiled loop; where it is None those on the damper are if any of them is at work, likewise those on the seat. Where
    it is False only those at work are: a loop that is compiled sooner, for them alone.
    """

    def select(hooks: tuple[str, ...]) -> Effects:
        chosen = tuple(effect for effect in effects if acts_on(type(effect), hooks))
        if carry_all is False or not (carry_all or chosen):
            return chosen
        first = {type(effect): effect for effect in reversed(chosen)}
        carried = [first.get(cls) or off(cls) for cls in _acting(EFFECTS.classes(), hooks)]
        further = [effect for effect in chosen if not any(effect is kept for kept in carried)]
        return (*carried, *further)

    return select(ON_DAMPER), select(ON_SEAT)


def has_inner_masses(driver: Driver, effects: Sequence[object]) -> bool:
    """Return whether anything moves within the driver's body, whose energy is then not recorded."""
    return driver.model != SINGLE_MASS or any(acts_on(type(effect), ("inner_mass",)) for effect in effects)


def seat_driver(driver: Driver, plant: Plant, effects: Sequence[object]) -> Effects:
    """Return the body that rests on the seat as a record of the time loop; none where the driver is a single mass.

    Raises:
        InputError: an effect gives the driver another body.
    """
    if driver.model == SINGLE_MASS:
        return ()
    if any(acts_on(type(effect), ("inner_mass",)) for effect in effects):
        problem = f"driver.model '{driver.model}' is a body, and so is 'driver.biodynamics'; leave one of them out"
        raise InputError(problem)
    found = body_matrices(BODIES[driver.model], plant.driver_mass)
    room = (0, MASSES - len(found.masses))
    masses, stiffness, damping = (np.pad(each, room).tolist() for each in found)
    return (SeatedBody(tuple(masses), tuple(map(tuple, stiffness)), tuple(map(tuple, damping))),)


@cache
def _acting(classes: tuple[type, ...], hooks: tuple[str, ...]) -> list[type]:
    """Return the effects that have one of the hooks."""
    return [cls for cls in classes if acts_on(cls, hooks)]


def augment_damper(record: DamperModel, effects: Effects) -> tuple[DamperModel, tuple[float, ...]]:
    """Return a damper's record with effects on it, and its state at rest."""
    initial: tuple[float, ...] = specification_of(type(record)).initial
    if not effects:
        return record, initial
    return AugmentedDamper(record, effects), initial + state_at_rest([type(effect) for effect in effects])
