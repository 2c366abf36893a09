"""What the cases of a set are to be, shuffled, and each case drawn: faults in which form, how strong, on which rig."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from seatsim.blind.make.draw_experiment import draw_experiment, draw_varied_experiment
from seatsim.blind.make.materiality import CommandedRuns, FaultlessRig, collinearity
from seatsim.blind.sealed import EFFECTS, KINDS, Kind, Label
from seatsim.blind.truth.experiment import CHANNELS, Experiment, Readings, read_channels, simulate_run
from seatsim.blind.truth.faults import SCENARIOS, Changes, Context, FaultScenario, Shape, scenarios_of
from seatsim.schema.errors import InputError, RunError, nearest

_PRESETS = ("mixed", "varied")
_BINGHAM_SHARE = 0.5
"""Of the rigs."""
_COMPLETE_SHARE, _AT_MOST_ONE_MISSING = 0.6, 0.93
"""Shares of the rigs that record every channel, and that lack at most one; the others lack two."""
_OPTIONAL = {"damper_force": 0.7, "coil_current": 0.3}
"""Channels that a rig may lack, and how likely each is the one: a load cell is what is saved first.

A fade could not be found without thermometer, so that no rig lacks it, whatever is wrong with it.
"""
LOG_TOLERANCE = 0.2
"""Of the logarithm of a materiality; closer would only cost simulations, as the target is drawn."""
_EVALUATIONS = 9
_MATERIAL_ALONE = 1.03
"""A little above the limit, as sizes are measured with a coarse step."""
_WEAKEST_TARGET, _STRONGEST_TARGET = 1.1, 8.0
_TINY = 1e-9
"""In place of a materiality of zero, where its logarithm is taken."""
_UNSTABLE_FACTOR = 0.6
"""Of a severity at which the rig was unstable: the new upper bound."""

_Known = list[tuple[float, float]]
"""Severities and their materialities."""


def _draw_missing_channels(rng: Generator) -> tuple[str, ...]:
    """Draw the channels that are not recorded: none in 60 % of cases, rarely two."""
    u = rng.random()
    if u < _COMPLETE_SHARE:
        return ()
    count = 1 if u < _AT_MOST_ONE_MISSING else 2
    return tuple(str(name) for name in rng.choice(list(_OPTIONAL), count, replace=False, p=list(_OPTIONAL.values())))


class CaseSpecification(NamedTuple):
    """Specification of a case: its kind, its effects (or the scenarios outside the library), on what kind of rig."""

    kind: Kind
    names: tuple[str, ...] = ()
    varied: bool = False

    def draw_rig(self, rng: Generator) -> Experiment:
        """Draw a rig and its protocol; neither kind nor names are used, so that nothing of it tells what is wrong."""
        gone = _draw_missing_channels(rng)
        channels = tuple(name for name in CHANNELS if name not in gone)
        bingham = rng.random() < _BINGHAM_SHARE
        return (draw_varied_experiment if self.varied else draw_experiment)(rng, bingham, channels)


def compose(cases: int, kinds: str | Sequence[str], rng: Generator) -> list[CaseSpecification]:
    """Return the specifications of a set, shuffled.

    `mixed`: a fifth none, a fifth two effects, a fifth outside, the rest one effect, the 24 effects equally often.
    `varied`: the same mix, every case on another rig. Otherwise a kind, which all cases are, or kinds that are gone
    through in turn.

    Raises:
        InputError: there is no such preset or kind.
    """
    specifications = _specify(_kinds(cases, kinds), rng, kinds == "varied")
    return [specifications[k] for k in rng.permutation(cases)]


def _kinds(cases: int, kinds: str | Sequence[str]) -> list[Kind]:
    """Return the kind of each case, before shuffling."""
    if kinds in ("mixed", "varied"):
        fifth = round(cases / 5)
        parts: dict[Kind, int] = {"none": fifth, "two": fifth, "outside": fifth, "one": max(cases - 3 * fifth, 0)}
        return [kind for kind, count in parts.items() for _ in range(count)][:cases]
    by_name, known = {str(kind): kind for kind in KINDS}, (*_PRESETS, *KINDS)
    chosen = [kinds] if isinstance(kinds, str) else kinds
    for name in chosen:
        if name not in by_name:
            raise InputError(f"kinds: {name!r} is not one of {', '.join(known)}{nearest(name, known)}")
    return [by_name[chosen[k % len(chosen)]] for k in range(cases)]


def _specify(kinds: list[Kind], rng: Generator, varied: bool) -> list[CaseSpecification]:
    """Return a specification for each kind; effects and scenarios are dealt so that each comes equally often."""
    singles, pairs = _Dealer(EFFECTS, rng), _Dealer(EFFECTS, rng)
    outside = _Dealer([scenario.name for scenario in scenarios_of("outside")], rng)

    def take(kind: Kind) -> tuple[str, ...]:
        if kind == "two":
            first = pairs.take()
            return first, pairs.take(first)
        return () if kind == "none" else ((singles if kind == "one" else outside).take(),)

    return [CaseSpecification(kind, take(kind), varied=varied) for kind in kinds]


class _Dealer:
    """Names dealt until none is left, then shuffled anew: every name equally often."""

    def __init__(self, names: Sequence[str], rng: Generator) -> None:
        self.names, self.rng = list(names), rng
        self.left: list[str] = []

    def take(self, but: str = "") -> str:
        """Deal a name that is not `but`."""
        if not self.left or self.left == [but]:
            self.left = [self.names[k] for k in self.rng.permutation(len(self.names))]
        place = -1 if self.left[-1] != but else -2
        return self.left.pop(place)


def draw_target(rng: Generator, top: float = _STRONGEST_TARGET) -> float:
    """Draw a materiality, log-uniform from the material limit to strong."""
    return float(np.exp(rng.uniform(math.log(_WEAKEST_TARGET), math.log(max(top, _WEAKEST_TARGET * 1.01)))))


def find_severity(
    size_of: Callable[[float], float], span: tuple[float, float], rng: Generator
) -> tuple[float, float] | None:
    """Return severity and materiality near a drawn target, or None where nothing plausible is material.

    Secant steps in the logarithms between bounds that close in; a fault too weak for the target gets a new, lower one.
    `size_of` returns the materiality of a severity, infinite where the rig is unstable.
    """
    target = draw_target(rng)
    low, high = span
    known: _Known = []
    s = min(max(1.0, low), high)
    for _ in range(_EVALUATIONS):
        size = size_of(s)
        if not math.isfinite(size):
            high = _UNSTABLE_FACTOR * s
            s = math.sqrt(max(low, s / 8.0) * high)
            if high <= low:
                return None
            continue
        known.append((s, size))
        if abs(math.log(max(size, _TINY) / target)) < LOG_TOLERANCE:
            break
        if size < target and s >= high * 0.999:
            if size < 1.15:
                return None
            target = draw_target(rng, size)
            s = min(max(s * (target / size), low), high)
            if s >= high * 0.999:
                break
            continue
        s = _next_severity(known, target, low, high)
    material = [pair for pair in known if pair[1] >= _MATERIAL_ALONE]
    return min(material, key=lambda pair: abs(math.log(pair[1] / target)), default=None)


def _next_severity(known: _Known, target: float, low: float, high: float) -> float:
    """Return the next severity: between the closest below and above, else on from the closest.

    The secant keeps a tenth away from both ends, and an extrapolation to a factor of 0.1 to 6, as materiality is not
    quite a power of the severity.
    """
    below = [pair for pair in known if pair[1] < target]
    above = [pair for pair in known if pair[1] >= target]
    if below and above:
        (s0, m0), (s1, m1) = max(below, key=lambda pair: pair[1]), min(above, key=lambda pair: pair[1])
        share = math.log(target / max(m0, _TINY)) / math.log(m1 / max(m0, _TINY))
        return float(math.exp(math.log(s0) + min(max(share, 0.1), 0.9) * math.log(s1 / s0)))
    s, size = (below or above)[-1]
    return float(min(max(s * min(max(target / max(size, _TINY), 0.1), 6.0), low), high))


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

    kind: Kind
    experiment: Experiment
    faults: tuple[_DrawnFault, ...]
    readings: list[Readings]

    def label(self) -> Label:
        """Return the label: kind, effects, blocks, and all that was drawn."""
        return {
            "kind": self.kind,
            "effects": [f.scenario.effect for f in self.faults if not f.scenario.outside],
            "blocks": [f.scenario.block for f in self.faults],
            "forms": [f.scenario.name for f in self.faults],
            "severities": [f.severity for f in self.faults],
            "materialities": [f.materiality for f in self.faults],
            "shapes": [f.shape for f in self.faults],
            "faulty_channels": [s.channel for f in self.faults for s in f.changes.sensor_faults],
            "missing": [name for name in CHANNELS if name not in self.experiment.channels],
            "background": sum(force.rms for force in self.experiment.background),
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
            case = None if faults is None else _settle(specification.kind, faults, rig)
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


def _settle(kind: Kind, faults: list[_DrawnFault], rig: FaultlessRig) -> _Case | None:
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
        if all(fault.net >= _MATERIAL for fault in measured):
            readings = [read_channels(experiment, total, k, motion) for k, motion in enumerate(motions)]
            return _Case(kind, experiment, tuple(measured), readings)
        faults = [_raise(fault, rig.context) for fault in measured]
    return None


def _sum_of_changes(faults: Sequence[_DrawnFault]) -> Changes:
    return sum((fault.changes for fault in faults), Changes())


def _measure(faults: Sequence[_DrawnFault], runs: CommandedRuns, rig: FaultlessRig) -> list[_DrawnFault] | None:
    """Return the faults with their materiality beside the others.

    None where the rig is unstable, or where two faults can hardly be distinguished.
    """
    sized, responses = [], []
    for k, fault in enumerate(faults):
        others = _sum_of_changes([other for j, other in enumerate(faults) if j != k])
        size, response = runs.materiality(fault.changes, others)
        net = size * rig.refit.unexplained_share(fault.changes, others)
        sized.append(fault._replace(materiality=size, net=net))
        responses.append(response)
    alike = collinearity(*responses) if len(responses) == 2 else 0.0
    is_case = alike <= _LARGEST_COLLINEARITY and all(np.isfinite(fault.materiality) for fault in sized)
    return sized if is_case else None


def _raise(fault: _DrawnFault, context: Context) -> _DrawnFault:
    """Return a fault that is not material net of tolerance at a higher severity, no higher than is plausible."""
    if fault.net >= _MATERIAL:
        return fault
    severity = min(fault.severity * _RAISE / max(fault.net, _WEAKEST), fault.scenario.span[1])
    return fault._replace(severity=severity, changes=fault.scenario.build(severity, fault.shape, context))
