"""Candidate explanations: every effect in every model structure, on every channel it may act on."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.effects.base import EFFECTS, ON_SEAT, Form, acts_on, same_place
from seatsim.recordings.recording import COMMANDS
from seatsim.rig.drivers import SINGLE_MASS
from seatsim.schema.arrays import Array
from seatsim.schema.fields import bounds, choices, describe, field_names
from seatsim.schema.registry import Record

_Fixed = Mapping[str, float | str]
"""Parameters that no fit changes."""
_INPUTS = ("floor_acceleration", "displacement")
"""Recorded inputs whose sensor may err: it moves every channel that is simulated from them."""
_LIMIT_STARTS = (1.0, 0.5, 0.7, 1.4, 2.0)
"""Factors on the start of a limit from which fits are begun, since a fit does not feel one far beyond the motion."""
_SEAT_SPRING = 4600.0
"""N/m; spring of the seat for which the effects state the stiffnesses at which fits start."""


class Candidate(NamedTuple):
    """An effect with some of its parameters free: where a fit starts, and between which bounds.

    `nominal` is the first free parameter in the nominal scenario: 0 unless the effect is one of that scenario's own,
    which the candidate then replaces. The first `sizes` free parameters are sizes, the others the effect's shape.
    """

    effect: str
    cls: type[Record]
    fixed: _Fixed
    free: tuple[str, ...]
    start: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    nominal: float = 0.0
    sizes: int = 1

    @property
    def scale(self) -> Array:
        """Natural size of each free parameter, shape (len(free),)."""
        size = np.abs(self.start)
        size[0] = max(size[0], abs(self.start[0] - self.nominal))
        return size

    def record(self, values: Array | Sequence[float]) -> Record:
        """Return the effect at these values of the free parameters."""
        return self.cls(**self.fixed, **dict(zip(self.free, map(float, values), strict=True)))

    @property
    def alone(self) -> Array:
        """The start with each size alone, shape (sizes, len(free)): the other sizes are 0."""
        starts = np.tile(self.start, (self.sizes, 1))
        starts[:, : self.sizes] *= np.eye(self.sizes)
        return starts

    def from_nominal(self, values: Sequence[float]) -> Array:
        """Return how far the sizes among some values are from those of the nominal scenario, shape (sizes,)."""
        away = np.array(values[: self.sizes])
        away[0] -= self.nominal
        return away

    @property
    def is_limit(self) -> bool:
        """Whether the effect falls as its first parameter grows in size, as with a limit or a clearance."""
        return self.limits[0]

    @property
    def limits(self) -> list[bool]:
        """Which free parameters are such limits: larger where the effect is off."""
        return [abs(self.off.get(name, 0.0)) > abs(start) for name, start in zip(self.free, self.start, strict=True)]

    @property
    def off(self) -> Mapping[str, float]:
        """The parameters at which the effect leaves the rig as it is, where that is not zero."""
        return EFFECTS.specification_of(self.cls).off

    @property
    def structure(self) -> Hashable:
        """The key that is equal for candidates that differ only in where their fit starts."""
        return self.effect, self.free, tuple(self.fixed.items())

    def is_other_form(self, other: Candidate) -> bool:
        """Whether this is the same effect in another form, on the same channel if it acts on one."""
        same = self.effect == other.effect and self.fixed.get("channel") == other.fixed.get("channel")
        return same and self.structure != other.structure

    def is_twin(self, other: Candidate) -> bool:
        """Whether this is another effect with the same parameters."""
        return self.effect != other.effect and (self.free, self.fixed) == (other.free, other.fixed)

    @property
    def block(self) -> str:
        """Block of the rig that the effect lives in."""
        return self.effect.partition(".")[0]


def list_candidates(problem: DiagnosisProblem, without: Sequence[str] = ()) -> list[Candidate]:
    """List the effects that the nominal scenario of a recording could lack, except those named in `without`."""
    found, reach = list[Candidate](), problem.settings.selection.shape_reach
    offered = {name: EFFECTS.find(name) for name in EFFECTS.names() if name not in without}
    fitting = {name: cls for name, cls in offered.items() if _fits(cls, problem)}
    for name, cls in fitting.items():
        for form, place in product(EFFECTS.specification_of(cls).forms, _places(cls, problem)):
            candidate = _candidate(name, cls, form, place, reach)
            at_start = candidate.record(candidate.start)
            own = next((each for each in problem.scenario.effects if same_place(each, at_start)), None)
            candidate = _suit(candidate, problem) if own is None else _change(candidate, own)
            found += _vary_start(candidate, problem)
    return found


def _change(candidate: Candidate, own: Record) -> Candidate:
    """Return the candidate as a change of an effect that the nominal scenario has: what it leaves is as it is there.

    The nominal scenario may have the right effect at a wrong size. A size is changed by the candidate's own start, a
    limit by a factor of what it is.
    """
    have: dict[str, float | str] = {name: getattr(own, name) for name in own._fields}
    at = np.array([float(have[name]) for name in candidate.free])
    # What the scenario leaves at 0 starts as in the form: a parameter has no natural size there.
    start = np.where(at == 0.0, candidate.start, at)
    if not candidate.is_limit:
        start[0] = at[0] + candidate.start[0]
    low, high = np.minimum(candidate.low, at), np.maximum(candidate.high, at)
    return candidate._replace(
        fixed={name: value for name, value in have.items() if name not in candidate.free},
        nominal=float(at[0]),
        start=tuple(start.tolist()),
        low=tuple(low.tolist()),
        high=tuple(high.tolist()),
        sizes=1,
    )


def _suit(candidate: Candidate, problem: DiagnosisProblem) -> Candidate:
    """Return the candidate as it suits the recording.

    Commands that it holds are held as long as those of the recording, and a stiffness beside the suspension's spring is
    scaled down to a spring that is softer.
    """
    plant = problem.scenario.plant
    if candidate.fixed.get("hold"):
        return candidate._replace(fixed={**candidate.fixed, "hold": problem.command_interval})
    if candidate.block != "suspension" or plant is None:
        return candidate
    units = {field.name: field.unit for field in describe(candidate.cls)}
    softer = min(1.0, plant.suspension_stiffness / _SEAT_SPRING)
    start, low, high = (
        tuple(softer * x if units[name] == "N/m" else x for name, x in zip(candidate.free, values, strict=True))
        for values in (candidate.start, candidate.low, candidate.high)
    )
    return candidate._replace(start=start, low=low, high=high)


def _vary_start(candidate: Candidate, problem: DiagnosisProblem) -> list[Candidate]:
    """Return the candidate from every start; the cost depends on a limit only where the motion reaches it."""
    starts, factors = list(zip(candidate.start, candidate.limits, strict=True)), [1.0]
    if candidate.is_limit:
        unit = next(field.unit for field in describe(candidate.cls) if field.name == candidate.free[0])
        reached = min(1.0, problem.reached.get(unit, math.inf) / abs(candidate.start[0]))
        factors = [reached * factor for factor in _LIMIT_STARTS]
    return [candidate._replace(start=tuple(f * x if limit else x for x, limit in starts)) for f in factors]


def _fits(cls: type[Record], problem: DiagnosisProblem) -> bool:
    """Whether the effect has something to act on in this recording."""
    specification = EFFECTS.specification_of(cls)
    if problem.bench and acts_on(cls, (*ON_SEAT, "plant", "frame_force")):
        return False
    if acts_on(cls, ("inner_mass",)) and problem.scenario.driver.model != SINGLE_MASS:
        return False
    # Where only the current is recorded, it drives the damper in the simulation, so that no fault of the coil shows.
    if acts_on(cls, ("coil",)) and set(COMMANDS).isdisjoint(problem.recording.channels):
        return False
    if specification.shown_by_fall and not problem.current_falls:
        return False
    return specification.suits(problem.scenario.damper.record)


def _places(cls: type[Record], problem: DiagnosisProblem) -> list[_Fixed]:
    """Return the channels that an effect may act on, or one empty name for an effect that acts on no channel."""
    if not EFFECTS.specification_of(cls).by_channel:
        return [{}]
    known = choices(cls, "channel")
    named = [*problem.channels, *_INPUTS]
    return [{"channel": name} for name in named if name in problem.recording.channels and name in known]


def _candidate(name: str, cls: type[Record], form: Form, place: _Fixed, reach: float) -> Candidate:
    """Return the candidate of one structure on one channel; parameters that the structure does not name stay off."""
    specification = EFFECTS.specification_of(cls)
    off = {field: 0.0 for field in field_names(cls) if field not in place} | dict(specification.off)
    fixed = {field: value for field, value in off.items() if field not in form.free} | dict(form.fixed) | dict(place)
    # The first parameter is the effect's size, which may be anything; the others are its shape.
    ranges = [
        form.within.get(field, _bound(cls, field, value, reach if k > 0 else None))
        for k, (field, value) in enumerate(form.free.items())
    ]
    low, high = zip(*ranges, strict=True)
    start = tuple(form.free.values())
    return Candidate(name, cls, fixed, tuple(form.free), start, low, high, sizes=form.sizes)


def _bound(cls: type[Record], field: str, value: float, reach: float | None) -> tuple[float, float]:
    """Return the bounds of a free parameter; one of shape, if it has a sign, stays within `reach` times its start."""
    low, high = bounds(cls, field)
    if reach is not None and low >= 0.0:
        return max(low, value / reach), min(high, value * reach)
    return low, high
