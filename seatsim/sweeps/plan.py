"""The numbered runs of a sweep: which values each has, and the scenario that they make.

    run = (replicate * points + point) * bases + base

A base is the scenario, or one of its variants. Replicates vary slowest: more of them only add runs at the end, and so
do more points where there is one replicate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from seatsim.scenario.expansion import expand
from seatsim.scenario.loading import read_scenario, reread
from seatsim.scenario.scenario import Scenario
from seatsim.schema.yaml_source import Source
from seatsim.sweeps.definition import MOST_RUNS, SweepDefinition
from seatsim.sweeps.design import count_points, resolve_design


class Base(NamedTuple):
    """A scenario before the design changes it, and the label of its variant; the same in every point."""

    source: Source
    label: Mapping[str, object]


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep, or those of some of its points from `first` on.

    `columns` holds the values of every varied key, a list over the points each; `places` where each key is stated.
    """

    bases: tuple[Base, ...]
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
        replicate, _, base = self._locate(run)
        label = self.values(run)
        source = self._change(run)
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

    def _change(self, run: int) -> Source:
        _, point, base = self._locate(run)
        source = self.bases[base].source.with_changes()
        for key, values in self.columns.items():
            source.put(key, values[point], self.places[key])
        return source


class Selection(NamedTuple):
    """Some runs of a sweep: a plan of their own, and pairs of the number in the sweep and the number in that plan."""

    plan: Plan
    runs: tuple[tuple[int, int], ...]


def make_plan(definition: SweepDefinition, foresee: Callable[[int], None] = lambda runs: None) -> Plan:
    """Return the runs of a sweep: the points of its design, for each variant of its scenario and each replicate.

    `foresee` is called with their number before any of them is made.

    Raises:
        InputError: there are too many, the design cannot be resolved, or a varied key is one that the scenario varies
            itself.
    """
    bases = tuple(Base(source, label) for source, label in expand(definition.scenario, {}))
    factors = {"points": count_points(definition), "variants": len(bases), "replicates": definition.replicates}
    runs = math.prod(factors.values())
    if runs > MOST_RUNS:
        shown = " x ".join(f"{number} {name}" for name, number in factors.items() if number > 1)
        raise definition.source.error((), f"makes {runs} runs ({shown}); permitted: at most {MOST_RUNS}. Vary fewer"
                                          " keys, or draw 'runs' points with design: sobol")  # fmt: skip
    foresee(runs)
    columns = resolve_design(definition)
    for key in columns:
        if key in bases[0].label:
            raise definition.source.error(("vary", key), "the scenario itself varies this key; leave it out of one")
    places = {key: definition.place(key) for key in columns}
    return Plan(bases, columns, places, len(next(iter(columns.values()))), definition.replicates)
