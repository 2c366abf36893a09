"""Draws a case: which kind, which faults in which form, how strong, on which rig with which channels."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.compose import CaseSpecification, find_severity
from seatsim.blind.make.materiality import CommandedRuns, FaultlessRig, collinearity
from seatsim.blind.sealed import EFFECTS, Label
from seatsim.blind.truth.experiment import CHANNELS, Experiment, Readings, read_channels, simulate_run
from seatsim.blind.truth.faults import SCENARIOS, Changes, Context, FaultScenario, Shape, scenarios_of
from seatsim.schema.errors import RunError

_ATTEMPTS = 8
"""Attempts with the same faults before others take their place: on some rigs an effect such as play is hardly seen."""
_EXCHANGES = 20
"""How often others take their place; some fault can be seen on every rig, so that more are never needed."""
_ROUNDS = 6
"""Of raising faults that are not material beside the others; each raises by 15 % or more."""
_LARGEST_COLLINEARITY = 0.9
"""Two faults whose responses correlate above this are one fault to any diagnoser, and are not drawn together."""
_MATERIAL = 1.02
"""A little above the limit of 1, so that noise does not decide whether a fault is there."""
_RAISE = 1.15
"""How much further than to the limit a fault is raised."""
_WEAKEST = 0.4
"""Materiality below which a fault is raised no faster, as response and severity are not proportional that far."""


class _DrawnFault(NamedTuple):
    """A scenario, its drawn shape and severity, its materiality beside the others: in all, and net of tolerance."""

    scenario: FaultScenario
    shape: Shape
    severity: float
    materiality: float
    changes: Changes
    net: float = 0.0


class _Case(NamedTuple):
    """A drawn case: the rig, what is wrong with it, what its channels show without noise; the last run is unseen."""

    specification: CaseSpecification
    experiment: Experiment
    faults: tuple[_DrawnFault, ...]
    readings: list[Readings]
    collinearity: float

    def label(self) -> Label:
        """Return the label: kind, effects, blocks, and all that was drawn."""
        return {
            "kind": self.specification.kind,
            "effects": [f.scenario.effect for f in self.faults if not f.scenario.outside],
            "blocks": [f.scenario.block for f in self.faults],
            "forms": [f.scenario.name for f in self.faults],
            "severities": [f.severity for f in self.faults],
            "materialities": [f.materiality for f in self.faults],
            "net_materialities": [f.net for f in self.faults],
            "shapes": [f.shape for f in self.faults],
            "faulty_channels": [s.channel for f in self.faults for s in f.changes.sensor_faults],
            "overlap": self.collinearity,
            "nominal": "bingham" if self.experiment.is_bingham else "bouc_wen",
            "missing": [name for name in CHANNELS if name not in self.experiment.channels],
            "temperatures": [run.temperature for run in self.experiment.runs],
            "background": sum(force.rms for force in self.experiment.background),
            "sample_rate": self.experiment.sample_rate,
            "tolerance": self.experiment.tolerance,
            "rig": dict(self.experiment.nominal),
            "order": self.specification._asdict(),
        }


def draw_case(specification: CaseSpecification, rng: Generator) -> _Case:
    """Draw a case to specification: a rig with its protocol, then faults that are material on it.

    The rig is drawn once and without regard to the faults: were it drawn again until they are material, its parameters
    and protocol would tell which they are. Effects that no draw makes material on it, or that its damper cannot have,
    give way to others drawn at random.

    Raises:
        RunError: no draw is material.
    """
    scenarios = _draw_scenarios(specification, rng)
    rig = FaultlessRig(specification.draw_rig(rng))
    for _ in range(_EXCHANGES):
        for _ in range(_ATTEMPTS):
            faults = _draw_faults(scenarios, rig, rng)
            case = None if faults is None else _settle(specification, faults, rig)
            if case is not None:
                return case
            scenarios = _draw_scenarios(specification, rng)
        outside = [scenario.name for scenario in scenarios_of("outside")]
        others = rng.choice(outside if specification.kind == "outside" else EFFECTS, len(scenarios), replace=False)
        specification = specification._replace(names=tuple(map(str, others)))
        scenarios = _draw_scenarios(specification, rng)
    raise RunError(f"no material case of kind {specification.kind} came of {_ATTEMPTS * _EXCHANGES} draws")


def _draw_scenarios(specification: CaseSpecification, rng: Generator) -> list[FaultScenario]:
    if specification.kind == "outside":
        return [SCENARIOS[name] for name in specification.names]
    choices = [scenarios_of(effect) for effect in specification.names]
    return [choice[int(rng.integers(len(choice)))] for choice in choices]


def _draw_faults(scenarios: Sequence[FaultScenario], rig: FaultlessRig, rng: Generator) -> list[_DrawnFault] | None:
    """Draw shapes, and severities that give each fault a drawn materiality when it is alone.

    None where one cannot be made material on this rig.
    """
    faults = []
    for scenario in scenarios:
        if scenario.bingham and not rig.experiment.is_bingham:
            return None
        shape = scenario.draw(rng, rig.context)
        build = partial(scenario.build, shape=shape, context=rig.context)

        def size_of(severity: float, build: Callable[[float], Changes] = build) -> float:
            return rig.runs.materiality(build(severity), Changes())[0]

        found = find_severity(size_of, scenario.span, rng)
        if found is None:
            return None
        faults.append(_DrawnFault(scenario, shape, *found, build(found[0])))
    return faults


def _settle(specification: CaseSpecification, faults: list[_DrawnFault], rig: FaultlessRig) -> _Case | None:
    """Close the loop with the faults in it; raise what is no longer material beside the others, or give up."""
    experiment = rig.experiment
    runs = range(len(experiment.runs))
    for _ in range(_ROUNDS):
        total = _sum_of_changes(faults)
        motions = [simulate_run(experiment, total, k) for k in runs]
        if not all(np.all(np.isfinite(motion.frame)) for motion in motions):
            return None
        commanded = CommandedRuns(experiment, [motion.command for motion in motions[:-1]])
        measured = _measure(faults, commanded, rig)
        if measured is None:
            return None
        faults, alike = measured
        if all(fault.net >= _MATERIAL for fault in faults):
            readings = [read_channels(experiment, total, k, motion) for k, motion in enumerate(motions)]
            return _Case(specification, experiment, tuple(faults), readings, alike)
        faults = [_raise(fault, rig.context) for fault in faults]
    return None


def _sum_of_changes(faults: Sequence[_DrawnFault]) -> Changes:
    return sum((fault.changes for fault in faults), Changes())


def _measure(
    faults: Sequence[_DrawnFault], runs: CommandedRuns, rig: FaultlessRig
) -> tuple[list[_DrawnFault], float] | None:
    """Return the faults with their materiality beside the others, and their collinearity; None where one is no case.

    That is where the rig is unstable, or where two faults can hardly be distinguished.
    """
    sized, responses = [], []
    for k, fault in enumerate(faults):
        others = _sum_of_changes([other for j, other in enumerate(faults) if j != k])
        size, response = runs.materiality(fault.changes, others)
        net = size * rig.refit.unexplained_share(fault.changes, others)
        sized.append(fault._replace(materiality=size, net=net))
        responses.append(response)
    alike = collinearity(*responses) if len(responses) == 2 else 0.0
    if alike > _LARGEST_COLLINEARITY or not all(np.isfinite(fault.materiality) for fault in sized):
        return None
    return sized, alike


def _raise(fault: _DrawnFault, context: Context) -> _DrawnFault:
    """Return a fault that is not material net of tolerance at a higher severity, no higher than is plausible."""
    if fault.net >= _MATERIAL:
        return fault
    severity = min(fault.severity * _RAISE / max(fault.net, _WEAKEST), fault.scenario.span[1])
    return fault._replace(severity=severity, changes=fault.scenario.build(severity, fault.shape, context))
