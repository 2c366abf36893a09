"""The numbered runs of a sweep: the points of its design, which values each run has, and the scenario that they make.

    run = (replicate * points + point) * bases + base

A base is the scenario, or one of its variants. Replicates vary slowest.

A design combines the values of all keys: every combination, side by side, or drawn from a sequence. One that is drawn
is resolved once, from the seed of the sweep, before anything runs.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seatsim.excitations.base import Excitation
from seatsim.scenario.loading import expand, read_scenario, reread
from seatsim.scenario.numbers import list_doubts
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError, list_sentences, raise_all
from seatsim.schema.validation import is_finite_number
from seatsim.schema.yaml_source import Source
from seatsim.sweeps.definition import MOST_RUNS, Axis, SweepDefinition

_Columns = Mapping[str, list[object]]
"""The values of every varied key, a list over the points each."""


def _count_points(definition: SweepDefinition) -> int:
    """Return how many points a design has, without making any of them."""
    if definition.table is not None:
        return len(next(iter(definition.table.columns.values())))
    lengths = [len(axis.values) for axis in definition.axes if axis.values is not None]
    if definition.design == "cross":
        return math.prod(lengths) * (1 if len(lengths) == len(definition.axes) else definition.runs or 1)
    return definition.runs or max(lengths, default=1)


def _resolve_design(definition: SweepDefinition) -> _Columns:
    """Return the points of a sweep, without its replicates and the variants of its scenario.

    Raises:
        InputError: the design needs a number of runs that is not stated, or lists that are paired differ in length.
    """
    if definition.table is not None:
        return definition.table.columns
    resolve = {"cross": _cross, "zip": _pair, "lhs": _fill_hypercube, "sobol": _follow_sobol}[definition.design]
    return {**resolve(definition)}


def _cross(definition: SweepDefinition) -> _Columns:
    """Return every combination of the listed values, each with the same joint draws of the others.

    The draws vary slowest; of the lists the first varies slowest.
    """
    listed = [axis for axis in definition.axes if axis.values is not None]
    drawn = [axis for axis in definition.axes if axis.values is None]
    draws = _draw(drawn, _count_draws(definition), definition.seed) if drawn else {}
    firsts = zip(*draws.values(), strict=True) if drawn else [()]
    points = itertools.product(firsts, *(axis.values or () for axis in listed))
    flat = [(*first, *rest) for first, *rest in points]
    columns = zip(*flat, strict=True)
    found = dict(zip([*draws, *(axis.key for axis in listed)], map(list, columns), strict=True))
    return {axis.key: found[axis.key] for axis in definition.axes}


def _pair(definition: SweepDefinition) -> _Columns:
    """Return the first values of all keys, then the second ones, and so on; distributions are drawn as often.

    A value that is alone in its list goes with all the others.
    """
    listed = {axis.key: list(axis.values) for axis in definition.axes if axis.values is not None}
    lengths = {key: len(values) for key, values in listed.items() if len(values) > 1}
    if len(set(lengths.values())) > 1:
        shown = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise definition.source.error(("vary",), f"design 'zip' pairs lists of one length; they have: {shown}")
    needs_draws = len(listed) < len(definition.axes)
    count = next(iter(lengths.values()), 0) or (_count_draws(definition) if needs_draws else 1)
    listed = {key: values * (count // len(values)) for key, values in listed.items()}
    if definition.runs not in (None, count):
        raise definition.source.error(("runs",), f"{definition.runs} is not permitted; the lists have {count} values")
    drawn = _draw([axis for axis in definition.axes if axis.values is None], count, definition.seed)
    return {axis.key: (listed | drawn)[axis.key] for axis in definition.axes}


def _fill_hypercube(definition: SweepDefinition) -> _Columns:
    from scipy.stats import qmc

    count = _count_draws(definition)
    sampler = qmc.LatinHypercube(len(definition.axes), seed=np.random.default_rng(definition.seed))
    return _map_cube(definition.axes, sampler.random(count))


def _follow_sobol(definition: SweepDefinition) -> _Columns:
    from scipy.stats import qmc

    count = _count_draws(definition)
    sampler = qmc.Sobol(len(definition.axes), seed=np.random.default_rng(definition.seed))
    # Powers of two are what the sequence is balanced for; the first points of one are those of a shorter one.
    return _map_cube(definition.axes, sampler.random_base2(math.ceil(math.log2(count)))[:count])


def _draw(axes: Sequence[Axis], count: int, seed: int) -> dict[str, list[object]]:
    return _map_cube(axes, np.random.default_rng(seed).random((count, len(axes))))


def _map_cube(axes: Sequence[Axis], cube: Array) -> dict[str, list[object]]:
    """Return the values of the axes at points of the unit cube, shape (N, len(axes))."""
    return {axis.key: axis.quantile(cube[:, k]) for k, axis in enumerate(axes)}


def _count_draws(definition: SweepDefinition) -> int:
    if definition.runs is None:
        raise definition.source.error((), f"key 'runs' is missing; design '{definition.design}' draws so many points")
    return definition.runs


class _Base(NamedTuple):
    """A scenario before the design changes it, and the label of its variant; the same in every point."""

    source: Source
    label: Mapping[str, object]


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep, or those of some of its points from `first` on.

    `columns` holds the values of every varied key, a list over the points each; `places` where each key is stated.
    """

    bases: tuple[_Base, ...]
    columns: Mapping[str, Sequence[object]]
    places: Mapping[str, str]
    points: int
    replicates: int

    @property
    def runs(self) -> int:
        """How many runs there are; they are numbered from 0."""
        return self.replicates * self.points * len(self.bases)

    @property
    def keys(self) -> list[str]:
        """What sets runs apart: labels of the scenario's own variants and sweep, then the varied keys."""
        return [*self.bases[0].label, *self.columns]

    def values(self, run: int) -> dict[str, object]:
        """Return what sets a run apart, by key."""
        _, point, base = self._locate(run)
        return {**self.bases[base].label, **{key: values[point] for key, values in self.columns.items()}}

    def every_value(self, key: str) -> Iterable[object]:
        """Return all values of a key, of its points or of the scenario's own variants and sweep."""
        return self.columns[key] if key in self.columns else [base.label[key] for base in self.bases]

    def scenario(self, run: int) -> Scenario:
        """Return the scenario of a run; a replicate adds its number to the seed.

        Raises:
            InputError: the values do not fit the scenario.
        """
        replicate, point, base = self._locate(run)
        label, source = self.values(run), self.bases[base].source.with_changes()
        for key, values in self.columns.items():
            source.put(key, values[point], self.places[key])
        first = self._first_scenarios.get(base)
        if first is None:
            first = self._first_scenarios[base] = read_scenario(source, label)
        scenario = reread(first, self._sections, source, label)
        return replace(scenario, seed=scenario.seed + replicate) if replicate else scenario

    def select(self, runs: Sequence[int]) -> Selection:
        """Return the part of the plan that some runs need, small enough to be sent."""
        located = [self._locate(run) for run in runs]
        points = sorted({point for _, point, _ in located})
        at = {point: index for index, point in enumerate(points)}
        columns = {key: [values[point] for point in points] for key, values in self.columns.items()}
        part = replace(self, columns=columns, points=len(points))
        inner = [(replicate * len(points) + at[point]) * len(self.bases) + base for replicate, point, base in located]
        return Selection(part, tuple(zip(runs, inner, strict=True)))

    @cached_property
    def _sections(self) -> list[str]:
        # What all points share was read with the first of them.
        varying = [key for key, values in self.columns.items() if any(value != values[0] for value in values)]
        return list(dict.fromkeys(key.partition(".")[0] for key in varying))

    @cached_property
    def _first_scenarios(self) -> dict[int, Scenario]:
        return {}

    def _locate(self, run: int) -> tuple[int, int, int]:
        rest, base = divmod(run, len(self.bases))
        return (*divmod(rest, self.points), base)


class Selection(NamedTuple):
    """Some runs of a sweep: a plan of their own, and pairs of the number in the sweep and the number in that plan."""

    plan: Plan
    runs: tuple[tuple[int, int], ...]


def make_plan(definition: SweepDefinition) -> Plan:
    """Return the runs of a sweep: the points of its design, for each variant of its scenario and each replicate.

    A varied key takes the place of the scenario's own sweep of it.

    Raises:
        InputError: there are too many, the design cannot be resolved, or a varied key is one that the scenario varies
            itself.
    """
    varied = definition.table.columns if definition.table else {axis.key for axis in definition.axes}
    own = definition.scenario.data.get("sweep")
    others = {"sweep": {key: own[key] for key in own if key not in varied}} if isinstance(own, dict) else {}
    bases = tuple(_Base(source, label) for source, label in expand(definition.scenario, others))
    factors = {"points": _count_points(definition), "variants": len(bases), "replicates": definition.replicates}
    runs = math.prod(factors.values())
    if runs > MOST_RUNS:
        shown = " x ".join(f"{number} {name}" for name, number in factors.items() if number > 1)
        raise definition.source.error(
            (),
            f"makes {runs} runs ({shown}); permitted: at most {MOST_RUNS}. Vary fewer"
            " keys, or draw 'runs' points with design: sobol",
        )
    columns = _resolve_design(definition)
    for key in columns:
        if key in bases[0].label:
            raise definition.source.error(("vary", key), "the scenario itself varies this key; leave it out of one")
    places = {key: definition.place(key) for key in columns}
    return Plan(bases, columns, places, len(next(iter(columns.values()))), definition.replicates)


_MOST_FLOORS = 40
"""Floors that are made to see whether they can be; more would take longer than the message is worth."""
_MOST_LEVELS = 1000
"""Different numbers of a key from which on only the least and the greatest are looked at."""


def check_plan(plan: Plan) -> list[str]:
    """Build the scenarios of those runs in which a value could be out of place.

    Bounds are intervals: in each combination of texts and mappings (models, classes) the least and the greatest number
    of each key is looked at, besides the first run with each of up to a thousand different numbers.

    Returns:
        What is doubtful about the values though they are permitted, a sentence each.

    Raises:
        InputError: a value is not permitted; the message has its place, the number of its run, and what is permitted.
    """
    floors: set[tuple[type[Excitation], str]] = set()
    doubts: dict[str, None] = {}
    for run in sorted(set(_list_telling_runs(plan))):
        try:
            scenario = plan.scenario(run)
            asked = (type(scenario.excitation), repr((scenario.excitation, scenario.solver.step)))
            if scenario.excitation is not None and asked not in floors and len(floors) < _MOST_FLOORS:
                floors.add(asked)
                with scenario.placed("excitation"):
                    scenario.excitation.floor(scenario.solver.step, scenario.seed)
        except InputError as error:
            raise_all([InputError(f"{said} (run {run} of {plan.runs})") for said in list_sentences(error)])
        doubts |= dict.fromkeys(list_doubts(scenario))
    return list(doubts)


def _list_telling_runs(plan: Plan) -> Iterator[int]:
    per_point = len(plan.bases)
    numbers = {
        key: [float(str(value)) for value in values]
        for key, values in plan.columns.items()
        if all(map(is_finite_number, values))
    }
    others = [values for key, values in plan.columns.items() if key not in numbers]
    combinations: dict[str, list[int]] = {}
    for point in range(plan.points):
        combinations.setdefault(repr([values[point] for values in others]), []).append(point)
    points = {found[0] for found in combinations.values()}
    for values in numbers.values():
        for found in combinations.values():
            points |= {min(found, key=lambda point: values[point]), max(found, key=lambda point: values[point])}
        first: dict[float, int] = {}
        for point, value in enumerate(values):
            first.setdefault(value, point)
        points |= set(first.values()) if len(first) <= _MOST_LEVELS else set()
    for point in points:
        yield from range(point * per_point, (point + 1) * per_point)
