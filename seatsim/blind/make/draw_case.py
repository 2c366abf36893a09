"""Draws a case: which kind, which faults in which form, how strong, on which rig with which channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from seatsim.blind.labels import EFFECTS, Kind, Label, Specification
from seatsim.blind.make.draw_experiment import SCATTER, draw_experiment
from seatsim.blind.make.draw_varied import draw_varied_experiment
from seatsim.blind.make.materiality import COARSE_STEP, CommandedRuns, collinearity
from seatsim.blind.make.severity import find_severity
from seatsim.blind.make.tolerance import ToleranceRefit
from seatsim.blind.truth.experiment import CHANNELS, Experiment, context_of, read_channels, simulate_run
from seatsim.blind.truth.faults.catalogue import SCENARIOS, scenarios_of
from seatsim.blind.truth.faults.scenario import Changes, Context, FaultScenario, Shape
from seatsim.blind.truth.sensors import Readings
from seatsim.schema.errors import RunError

ATTEMPTS = 14
"""Attempts with the same faults before others are drawn: on some rigs an effect such as play can hardly be seen."""
ROUNDS = 6
"""Of raising faults that are not material beside the others; each raises by 15 % or more."""
LARGEST_COLLINEARITY = 0.9
"""Two faults whose responses correlate above this are one fault to any diagnoser, and are not drawn together."""
MATERIAL = 1.02
"""A little above the limit of 1, so that noise does not decide whether a fault is there."""
RAISE = 1.15
"""How much further than to the limit a fault is raised."""
WEAKEST = 0.4
"""Materiality below which a fault is raised no faster, as response and severity are not proportional that far."""
BINGHAM_SHARE = 0.25
"""Of the rigs whose faults need neither damper."""
COMPLETE_SHARE, AT_MOST_ONE_MISSING = 0.6, 0.93
"""Shares of the rigs that record every channel, and that lack at most one; the others lack two."""
OPTIONAL = {"damper_force": 0.5, "coil_current": 0.2, "damper_temperature": 0.3}
"""Channels that a rig may lack, and how likely each is the one: a load cell is what is saved first."""


@dataclass(frozen=True)
class CaseSpecification:
    """Specification of a case: its kind, and its effects (or the scenarios outside the library).

    `missing` are the channels not recorded (None: drawn), `background` is a random force on the frame, N rms, and
    `scatter` the largest relative error of a nominal parameter. `varied`: the rig is drawn too, and these two with it.
    """

    kind: Kind
    names: tuple[str, ...] = ()
    missing: tuple[str, ...] | None = None
    background: float = 0.0
    scatter: float = SCATTER
    varied: bool = False

    def as_dict(self) -> Specification:
        """Return it as it stands in a label."""
        missing = None if self.missing is None else list(self.missing)
        return {
            "kind": self.kind, "names": list(self.names), "missing": missing, "background": self.background,
            "scatter": self.scatter, "varied": self.varied,
        }  # fmt: skip


@dataclass(frozen=True)
class DrawnFault:
    """A scenario, its drawn shape and severity, its materiality beside the others: in all, and net of tolerance."""

    scenario: FaultScenario
    shape: Shape
    severity: float
    materiality: float
    changes: Changes
    net: float = 0.0


@dataclass(frozen=True)
class Case:
    """A drawn case: the rig, what is wrong with it, what its channels show without noise; the last run is unseen."""

    specification: CaseSpecification
    experiment: Experiment
    faults: tuple[DrawnFault, ...]
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
            "order": self.specification.as_dict(),
        }


def draw_case(specification: CaseSpecification, rng: Generator) -> Case:
    """Draw a case to specification; faults that cannot be made material in these runs are drawn anew.

    Effects that no draw makes material give way to others drawn at random.

    Raises:
        RunError: no draw of something outside the library is material.
    """
    for _ in range(ATTEMPTS):
        case = _attempt(specification, rng)
        if case is not None:
            return case
    if specification.kind in ("one", "two"):
        other = tuple(str(name) for name in rng.choice(EFFECTS, len(specification.names), replace=False))
        return draw_case(replace(specification, names=other), rng)
    raise RunError(f"no material case of kind {specification.kind} came of {ATTEMPTS} draws")


def draw_missing_channels(rng: Generator) -> tuple[str, ...]:
    """Draw the channels that are not recorded: none in 60 % of cases, rarely two."""
    u = rng.random()
    if u < COMPLETE_SHARE:
        return ()
    count = 1 if u < AT_MOST_ONE_MISSING else 2
    return tuple(str(name) for name in rng.choice(list(OPTIONAL), count, replace=False, p=list(OPTIONAL.values())))


def _draw_scenarios(specification: CaseSpecification, rng: Generator) -> list[FaultScenario]:
    if specification.kind == "outside":
        return [SCENARIOS[name] for name in specification.names]
    choices = [scenarios_of(effect) for effect in specification.names]
    return [choice[int(rng.integers(len(choice)))] for choice in choices]


def _draw_rig(specification: CaseSpecification, scenarios: Sequence[FaultScenario], rng: Generator) -> Experiment:
    """Draw a rig on which the scenarios can be at work and be found."""
    missing = specification.missing if specification.missing is not None else draw_missing_channels(rng)
    needed = {name for scenario in scenarios for name in scenario.needs}
    channels = tuple(name for name in CHANNELS if name not in missing or name in needed)
    bingham = rng.random() < BINGHAM_SHARE or any(scenario.bingham for scenario in scenarios)
    warm = any(scenario.warm for scenario in scenarios)
    if specification.varied:
        return draw_varied_experiment(rng, bingham, channels, warm)
    return draw_experiment(rng, bingham, channels, warm, specification.scatter, specification.background)


def _attempt(specification: CaseSpecification, rng: Generator) -> Case | None:
    """Draw rig, shapes and severities once; None where a fault cannot be made material on this rig."""
    scenarios = _draw_scenarios(specification, rng)
    experiment = _draw_rig(specification, scenarios, rng)
    recorded = range(len(experiment.runs) - 1)
    motions = [simulate_run(experiment, Changes(), k, step=COARSE_STEP) for k in recorded]
    runs = CommandedRuns(experiment, [motion.command for motion in motions])
    context = context_of(experiment, [read_channels(experiment, Changes(), k, motions[k]) for k in recorded])
    faults: list[DrawnFault] = []
    for scenario in scenarios:
        fault = _draw_fault(scenario, runs, context, rng)
        if fault is None:
            return None
        faults.append(fault)
    refit = ToleranceRefit(experiment, runs.commands) if faults else None
    return _settle(specification, experiment, faults, context, refit)


def _draw_fault(scenario: FaultScenario, runs: CommandedRuns, context: Context, rng: Generator) -> DrawnFault | None:
    """Draw a fault's shape, and the severity that gives it a drawn materiality when it is alone."""
    shape = scenario.draw(rng, context)

    def size_of(severity: float) -> float:
        return runs.materiality(scenario.build(severity, shape, context), Changes())[0]

    found = find_severity(size_of, scenario.span, rng)
    if found is None:
        return None
    severity, size = found
    return DrawnFault(scenario, shape, severity, size, scenario.build(severity, shape, context))


def _settle(
    specification: CaseSpecification, experiment: Experiment, faults: list[DrawnFault], context: Context,
    refit: ToleranceRefit | None,
) -> Case | None:  # fmt: skip
    """Close the loop with the faults in it; raise what is no longer material beside the others, or give up."""
    runs = range(len(experiment.runs))
    for _ in range(ROUNDS):
        total = _sum_of_changes(faults)
        motions = [simulate_run(experiment, total, k) for k in runs]
        if not all(np.all(np.isfinite(motion.frame)) for motion in motions):
            return None
        commanded = CommandedRuns(experiment, [motion.command for motion in motions[:-1]])
        measured = _measure(faults, commanded, refit)
        if measured is None:
            return None
        faults, alike = measured
        if all(fault.net >= MATERIAL for fault in faults):
            readings = [read_channels(experiment, total, k, motion) for k, motion in enumerate(motions)]
            return Case(specification, experiment, tuple(faults), readings, alike)
        faults = [_raise(fault, context) for fault in faults]
    return None


def _sum_of_changes(faults: Sequence[DrawnFault]) -> Changes:
    return sum((fault.changes for fault in faults), Changes())


def _measure(
    faults: Sequence[DrawnFault], runs: CommandedRuns, refit: ToleranceRefit | None
) -> tuple[list[DrawnFault], float] | None:
    """Return the faults with their materiality beside the others, and their collinearity; None where one is no case.

    That is where the rig is unstable, or where two faults can hardly be distinguished.
    """
    sized, responses = [], []
    for k, fault in enumerate(faults):
        others = _sum_of_changes([other for j, other in enumerate(faults) if j != k])
        size, response = runs.materiality(fault.changes, others)
        net = size * refit.unexplained_share(fault.changes, others) if refit else size
        sized.append(replace(fault, materiality=size, net=net))
        responses.append(response)
    alike = collinearity(*responses) if len(responses) == 2 else 0.0
    if alike > LARGEST_COLLINEARITY or not all(np.isfinite(fault.materiality) for fault in sized):
        return None
    return sized, alike


def _raise(fault: DrawnFault, context: Context) -> DrawnFault:
    """Return a fault that is not material net of tolerance at a higher severity, no higher than is plausible."""
    if fault.net >= MATERIAL:
        return fault
    severity = min(fault.severity * RAISE / max(fault.net, WEAKEST), fault.scenario.span[1])
    return replace(fault, severity=severity, changes=fault.scenario.build(severity, fault.shape, context))
