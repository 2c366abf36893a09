"""How far the figures of a report may be trusted, stated by the factors of NASA-STD-7009B.

There people judge the levels; here they follow from the result alone, so that equal results have equal levels: each is
the number of conditions that hold before the first that does not. What nothing is known of has level 0: it may be
right. A kind of result lists only the conditions that it can meet at all.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

from seatsim.dampers.base import CONFIDENCE, DAMPERS, find_confidence
from seatsim.provenance.statement import current_invocation
from seatsim.report.blocks import Block, Section
from seatsim.report.formatting import explain, format_sentence, read_words, show_table
from seatsim.schema.printing import UNKNOWN, format_number, format_percent
from seatsim.schema.registry import name_of
from seatsim.schema.text import join_names

_SMALL, NEGLIGIBLE = 0.01, 0.001
"""Shares of the energy, and of an output, from which on a numerical error is so."""
FAIR, GOOD = 0.25, 0.10
"""Shares of the signals' spread up to which an error on held-out data is so."""
NEAR_NOISE = 1.2
"""Error over the noise of the sensors up to which nothing is left to explain."""
EXPLAINED = 0.8
"""Share of the variance that the varied keys must explain."""
ENOUGH_RUNS = 100


class Factor(NamedTuple):
    """A factor of credibility: its name, what is known in words, and which of its first conditions hold."""

    name: str
    evidence: str
    holds: Sequence[bool]

    @property
    def level(self) -> int:
        """The number of conditions that hold before the first that does not."""
        return [*map(bool, self.holds), False].index(False)


@lru_cache(maxsize=1)
def read_conditions() -> Mapping[str, Sequence[str]]:
    """Return what each level of a factor asks for beyond the one below."""
    shares = {"small": _SMALL, "fair": FAIR, "good": GOOD, "explained": EXPLAINED}
    facts = {name: f"{share:.0%}" for name, share in shares.items()}
    facts |= {"negligible": f"{NEGLIGIBLE:.1%}", "near_noise": str(NEAR_NOISE), "enough_runs": str(ENOUGH_RUNS)}
    return {name: [text.format(**facts) for text in texts] for name, texts in read_words().conditions.items()}


def show_card(factors: Sequence[Factor]) -> Section:
    """Return the section on how far the figures of a report may be trusted."""
    rows = []
    for each in factors:
        # What the next level asks for, where this kind of result can reach one.
        asked = [*read_conditions()[each.name][: len(each.holds)], UNKNOWN][each.level]
        rows.append((each.name, f"{each.level}\u00a0of\u00a0{len(each.holds)}", format_sentence(each.evidence), asked))
    blocks: list[Block] = [*explain("credibility"), *show_table("credibility", rows, 4)]
    return Section("credibility", "How far to trust this", blocks)


def say_doubt(factors: Sequence[Factor]) -> str:
    """Return in a sentence which factor falls the furthest behind what could be reached; empty where none does."""
    weakest = min(factors, key=lambda factor: factor.level / len(factor.holds))
    if weakest.level == len(weakest.holds):
        return ""
    return format_sentence(f"the weakest point of this result is its {weakest.name}: {weakest.evidence}")


def verify(words: str, errors: Iterable[float]) -> Factor:
    """Return the factor of numerical errors, as shares of 1; `words` say what the largest is of, `{}` being it."""
    found = [float(error) for error in errors]
    known = bool(found) and all(map(math.isfinite, found))
    worst = max(found) if known else math.inf
    said = words.format(_format_share(worst)) if known else "no energy balance is known"
    return Factor("verification", said, (known, worst <= _SMALL, worst <= NEGLIGIBLE))


def validate(compared: int, held_out: int, error: float | None, noise: float | None = None) -> Factor:
    """Return the factor of recordings: runs compared, those of them that took no part in a fit, error and noise.

    One that agrees better than its noise was made of the simulation, and validates nothing.
    """
    if not compared or error is None:
        return Factor("validation", "no recording of this rig was compared", (False,) * 4)
    is_measured = noise is None or 0.0 < noise < NEAR_NOISE * error
    alone = f", sensor noise alone makes {_format_share(noise)}" if noise else ""
    kept = f"{held_out} of {compared} runs {'was' if held_out == 1 else 'were'}" if held_out else ""
    kept = kept or "no run is known to be"
    said = f"the error is {_format_share(error)} of the signals' spread{alone}; {kept} kept out of all fits"
    good = held_out > 1 and error <= max(GOOD, NEAR_NOISE * (noise or 0.0))
    return Factor("validation", said, (True, held_out > 0, is_measured and error <= FAIR, good))


def trace_inputs(
    doubts: Sequence[str],
    dampers: Iterable[type] = (),
    parameters_known: bool | None = None,
    loose: Sequence[str] = (),
    is_measured: bool = False,
    inputs: int | None = None,
) -> Factor:
    """Return the factor of inputs.

    Args:
        doubts: ranges left, values that no seat has.
        dampers: the models used.
        parameters_known: whether parameters have a stated tolerance or were fitted; None where no file can say so.
        loose: parameters that no data determine.
        is_measured: no figure is simulated, so that no model is needed.
        inputs: files whose hashes are kept; None where the manifest of the command at work counts them.
    """
    if inputs is None and (invocation := current_invocation()):
        # Drafts that were read back are gone.
        inputs = sum(path.is_file() for path in invocation.reads)
    known = {DAMPERS.find(name) for name in DAMPERS.names()}
    sources = dict(sorted((name_of("damper", cls), find_confidence(cls)) for cls in set(dampers) & known))
    parts = [
        "inputs are not recorded" if inputs is None else f"hashes of {inputs} input file{'s' * (inputs != 1)} kept",
        f"{len(doubts)} doubt{'s' * (len(doubts) > 1)} in the notes" if doubts else "no doubt about ranges or values",
        *(f"{name}: {word} ({CONFIDENCE[word]})" for name, word in sources.items()),
    ]
    if parameters_known:
        parts.append("parameters are known within a stated tolerance, or fitted to records")
    elif not is_measured:
        parts.append("no file says how well the parameters are known")
    if loose:
        parts.append(f"not determined: {join_names(loose)}")
    published = set(sources.values()) == {"published"} or (is_measured and not sources)
    last = [] if parameters_known is None else [parameters_known and not loose]
    return Factor("input pedigree", "; ".join(parts), (inputs is not None, not doubts, published, *last))


def state_intervals(intervals: Sequence[str], *further: bool) -> Factor:
    """Return the factor of uncertainty: what has an interval, and which further conditions hold."""
    said = f"intervals are stated for {join_names(intervals)}" if intervals else ""
    said = said or "no figure has an interval or a standard deviation"
    return Factor("uncertainty", said, (bool(intervals), *further))


def count_variations(runs: int, varied: Sequence[str] | None = None, said: str = "", *further: bool) -> Factor:
    """Return the factor of robustness.

    Args:
        runs: that were simulated or recorded.
        varied: keys that were varied or refitted; None where such a result has none.
        said: what stands behind the number of runs.
        further: which further conditions hold.
    """
    words = "not studied" if runs < 2 else f"{runs} runs side by side; no tolerance was varied"
    if varied:
        keys = join_names(varied) if len(varied) <= 3 else f"{len(varied)} keys"
        words = f"{keys} varied over {runs} runs{said}"
    own = [] if varied is None else [bool(varied)]
    return Factor("robustness", words, (runs > 1, *own, *further))


def _format_share(value: float) -> str:
    """Return a share in per cent, or as a power of ten where it is small."""
    return format_percent(value) if value >= NEGLIGIBLE or value == 0 else format_number(value, 2)
