"""Levels of credibility: for each factor conditions in order, of which a level is the number that hold from the first.

The factors are those of NASA-STD-7009B. There people judge the levels; here they follow from the evidence alone, so
that equal results have equal levels. What nothing is known of has level 0: it may be right.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from seatsim.dampers.base import CONFIDENCE
from seatsim.plots.labels import format_number, format_percent
from seatsim.report.credibility.evidence import Evidence
from seatsim.schema.text import join_names

_SMALL, NEGLIGIBLE = 0.01, 0.001
"""Shares of the energy, and of an output, from which on a numerical error is so."""
FAIR, GOOD = 0.25, 0.10
"""Shares of the signals' spread up to which an error on held-out data is so."""
NEAR_NOISE = 1.2
"""Error over the noise of the sensors up to which nothing is left to explain."""
EXPLAINED = 0.8
"""Share of the variance that the varied keys must explain."""
_ENOUGH_RUNS = 100


class _Condition(NamedTuple):
    """What a level asks for beyond the one below, in words and as a test."""

    words: str
    holds: Callable[[Evidence], bool]


class Factor(NamedTuple):
    """A factor of credibility: its name, the conditions of levels 1, 2, ... in order, and its evidence in words."""

    name: str
    conditions: Sequence[_Condition]
    describe: Callable[[Evidence], str]


def find_level(factor: Factor, evidence: Evidence) -> int:
    """Return the level, 0 to 4: the number of conditions that hold before the first that does not."""
    level = 0
    while level < len(factor.conditions) and factor.conditions[level].holds(evidence):
        level += 1
    return level


def _list_numerical_errors(known: Evidence) -> list[float]:
    return [value for value in (known.energy, known.step) if value is not None]


def _error(known: Evidence) -> float:
    return float("inf") if known.error is None else known.error


def _is_measured(known: Evidence) -> bool:
    """Whether the recording can be one of a rig: one that agrees better than its noise was made of the simulation."""
    return known.noise is None or 0.0 < known.noise < NEAR_NOISE * _error(known)


def _is_good(known: Evidence) -> bool:
    return known.held_out > 1 and _error(known) <= max(GOOD, NEAR_NOISE * (known.noise or 0.0))


def _is_published(known: Evidence) -> bool:
    words = set(known.dampers.values())
    return words == {"published"} or not (words or "measured" not in known.kind)


def _say_verification(known: Evidence) -> str:
    parts = []
    if known.energy is not None:
        parts.append(f"up to {_format_share(known.energy)} of the energy is unaccounted for")
    if known.step is not None:
        parts.append(f"half the step changes an output by up to {_format_share(known.step)}")
    return "; ".join(parts) or "no energy balance is known"


def _say_validation(known: Evidence) -> str:
    if not known.compared or known.error is None:
        return "no recording of this rig was compared"
    held = f"{known.held_out} of {known.compared} took" if known.held_out else "none is known to have taken"
    noise = f", noise alone makes {_format_share(known.noise)}" if known.noise else ""
    size = f"error of {_format_share(known.error)} of the signals' spread{noise}"
    return f"{size}; of the recorded runs {held} no part in a fit"


def _say_pedigree(known: Evidence) -> str:
    kept = f"hashes of {known.inputs} input file{'s' * (known.inputs != 1)} kept"
    parts = ["inputs are not recorded" if known.inputs is None else kept]
    parts.append(f"doubts: {len(known.doubts)}, in the notes" if known.doubts else "no doubt about ranges or values")
    parts += [f"{name}: {word} ({CONFIDENCE[word]})" for name, word in known.dampers.items()]
    if known.parameters_known:
        parts.append("parameters are known within a stated tolerance, or fitted to records")
    elif "measured" not in known.kind:
        parts.append("no file says how well the parameters are known")
    return "; ".join([*parts, *([f"not determined: {join_names(known.loose)}"] if known.loose else [])])


def _say_uncertainty(known: Evidence) -> str:
    if not known.intervals:
        return "no figure has an interval or a standard deviation"
    budget = "; the error is divided into step, inputs, data and model form" if known.budget else ""
    return f"stated for {join_names(known.intervals)}{budget}"


def _say_robustness(known: Evidence) -> str:
    if not known.varied:
        return "not studied" if known.runs < 2 else f"{known.runs} runs side by side; no tolerance was varied"
    keys = join_names(known.varied) if len(known.varied) <= 3 else f"{len(known.varied)} keys"
    share = "" if known.explained is None else f"; they explain {format_percent(max(0.0, known.explained))} of comfort"
    drawn = f", {len(known.drawn)} of them drawn from distributions," if known.drawn else ""
    return f"{keys} varied{drawn} over {known.runs} runs{share}"


def _format_share(value: float) -> str:
    """Return a share in per cent, or as a power of ten where it is small."""
    return format_percent(value) if value >= NEGLIGIBLE or value == 0 else format_number(value, 2)


_VERIFICATION = (
    _Condition("an energy balance or a run with half the step is known", lambda e: bool(_list_numerical_errors(e))),
    _Condition(f"its error is at most {_SMALL:.0%}", lambda e: max(_list_numerical_errors(e)) <= _SMALL),
    _Condition(f"its error is at most {NEGLIGIBLE:.1%}", lambda e: max(_list_numerical_errors(e)) <= NEGLIGIBLE),
)
_VALIDATION = (
    _Condition("a recording is compared", lambda e: e.compared > 0 and e.error is not None),
    _Condition("a recorded run took no part in a fit", lambda e: e.held_out > 0),
    _Condition(
        f"the recording has sensor noise, and the error is at most {FAIR:.0%} of the signals' spread",
        lambda e: _is_measured(e) and _error(e) <= FAIR,
    ),
    _Condition(
        f"the error is at most {GOOD:.0%}, or {NEAR_NOISE} times the noise, on two held-out runs or more", _is_good
    ),
)
_PEDIGREE = (
    _Condition("the manifest keeps the hashes of the inputs", lambda e: e.inputs is not None),
    _Condition("no model leaves its range, and no value is doubtful", lambda e: not e.doubts),
    _Condition("the equation of every damper was seen at its source", _is_published),
    _Condition(
        "parameters are known within a stated tolerance or fitted to records, and the data determine all that were"
        " fitted",
        lambda e: e.parameters_known and not e.loose,
    ),
)
_UNCERTAINTY = (
    _Condition("some figure has an interval, a standard deviation or a noise floor", lambda e: bool(e.intervals)),
    _Condition(
        "parameters or inputs have a standard deviation or a distribution",
        lambda e: bool(e.drawn) or e.parameter_intervals,
    ),
    _Condition("the answer has an interval", lambda e: e.answer_interval),
    _Condition("the error is divided into step, inputs, data and model form", lambda e: e.budget),
)
_ROBUSTNESS = (
    _Condition("there is more than one run", lambda e: e.runs > 1),
    _Condition("keys are varied, or refitted within their tolerance", lambda e: bool(e.varied)),
    _Condition(
        f"the varied keys explain {EXPLAINED:.0%} or more of the variance of comfort",
        lambda e: e.explained is not None and e.explained >= EXPLAINED,
    ),
    _Condition(
        f"keys are drawn from distributions, over {_ENOUGH_RUNS} runs or more, and runs beyond limits are counted",
        lambda e: bool(e.drawn) and e.runs >= _ENOUGH_RUNS and e.limits,
    ),
)
FACTORS = (
    Factor("verification", _VERIFICATION, _say_verification),
    Factor("validation", _VALIDATION, _say_validation),
    Factor("input pedigree", _PEDIGREE, _say_pedigree),
    Factor("uncertainty", _UNCERTAINTY, _say_uncertainty),
    Factor("robustness", _ROBUSTNESS, _say_robustness),
)
_ANY = Evidence("any", inputs=1, dampers={"any": "published"}, intervals=["any"], runs=2)
_COMPARED = _ANY._replace(compared=2, held_out=2, error=0.05, parameters_known=True, parameter_intervals=True)
REACH = {
    "runs": _ANY._replace(energy=0.0, intervals=[]),
    "sweep": _ANY._replace(
        energy=0.0,
        drawn=["any"],
        answer_interval=True,
        runs=_ENOUGH_RUNS,
        varied=["any"],
        explained=1.0,
        limits=True,
    ),
    "gap": _COMPARED._replace(noise=0.05, parameter_intervals=False),
    "diagnosis": _COMPARED._replace(step=0.0, noise=0.05, answer_interval=True, budget=True, varied=["any"]),
    "identification": _COMPARED,
    "measured bench": _ANY,
    "simulated bench": _ANY,
    "measured seat test": _ANY._replace(varied=["any"]),
    "simulated seat test": _ANY._replace(varied=["any"]),
}
REACH = {kind: most._replace(kind=kind) for kind, most in REACH.items()}
"""The most that is ever known of a result of each kind: what it reaches is the most that can be reached."""
