"""What diagnoses find, as tables on the terminal: the score of a sealed set, and the smallest sizes found on a rig."""

from __future__ import annotations

from collections.abc import Mapping

from rich.table import Table

from seatsim.blind.score.rates import Rate
from seatsim.blind.score.score import Failure, Score
from seatsim.cli.show_table import make_table

_RATE = ("share", "count", "95 % interval")
_LISTED = 12
"""Failures in the table."""


def make_score_tables(score: Score) -> list[Table]:
    """Return the tables of a score, the summary first."""
    named = [(truth, _count(named)) for truth, named in score.confusion.items()]
    every = score.reliability
    bins = [(f"{b.low:.4f} - {b.high:.4f}", f"{b.stated:.4f}", f"{b.true:.4f}", str(b.count)) for b in every]
    sizes = [(s.case, s.effect, s.parameter, f"{s.true:.4g}", f"{s.found:.4g}") for s in score.found_sizes]
    found = [make_table("sizes of effects that were found", ("case", "effect", "parameter", "true", "found"), sizes)]
    failures = [_describe(failure) for failure in score.failures[:_LISTED]]
    if (more := len(score.failures) - _LISTED) > 0:
        failures.append((f"and {more} more", *[""] * 6))
    headings = ("case", "truth", "limit x", "missing", "verdict", "named", "where")
    return [
        make_table(f"blind score, {score.cases} cases", ("what", *_RATE), _summarise(score)),
        make_table("by effect", ("effect", *_RATE), [(name, *_cells(rate)) for name, rate in score.effects.items()]),
        make_table("what was named", ("truth", "named (times)"), named, left=(0, 1)),
        make_table("reliability of the marginal probabilities", ("from - to", "stated", "true", "count"), bins),
        *(found if sizes else []),
        make_table("failures", headings, failures),
    ]


def _cells(rate: Rate) -> tuple[str, str, str]:
    low, high = rate.interval
    return f"{rate.value:.3f}", f"{rate.right}/{rate.total}", f"{low:.2f}-{high:.2f}"


def _count(named: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in named.items())


def _summarise(score: Score) -> list[tuple[str, ...]]:
    """Return the rows of the summary: rates of what is right, then figures of probabilities and of the shrink."""
    rates = {"right": score.right} | {f"right: {kind}": value for kind, value in score.kinds.items()}
    rates |= {
        "outside: unknown and right block": score.outside_with_block,
        "top-1 (one effect)": score.top1,
        "wrong effect named (one effect)": score.wrong_names,
        "top-3 (one effect)": score.top3,
        "right block first": score.block,
        "right block first, merged as isolable": score.block_coarse,
        "false alarms": score.false_alarms,
        "gap detected": score.detected,
        "two effects: recall": score.two_recall,
        "two effects: precision": score.two_precision,
    }
    rows: list[tuple[str, ...]] = [(name, *_cells(rate)) for name, rate in rates.items() if rate.total]
    if score.untouched:
        said, cases = _count(score.untouched), str(sum(score.untouched.values()))
        rows.append(("untouched carriers (not scored)", said, cases, ""))
    figures = {"calibration error (ECE)": f"{score.calibration_error:.4f}", "Brier": f"{score.brier:.4f}"}
    figures["mean group size"] = f"{score.group_size:.2f}"
    rows += [(), *((name, figure, "", "") for name, figure in figures.items())]
    for word, shrink in (("stated", score.shrink), ("predicted", score.shrink and score.shrink.predicted)):
        if shrink is not None:
            rows.append((f"shrink: |{word} - true|", f"{shrink.mean_difference:.3f}", str(len(shrink.cases)), ""))
            rows.append((f"shrink: {word} - true", f"{shrink.bias:+.3f}", "", ""))
            rows.append((f"shrink: interval {word} covers", *_cells(shrink.coverage)))
    return rows


def _describe(failure: Failure) -> tuple[str, ...]:
    true = ", ".join(failure.effects) or ", ".join(failure.forms) or "none"
    sizes, missing = ", ".join(f"{size:.1f}" for size in failure.materialities), ", ".join(failure.missing)
    named = ", ".join(failure.selected or failure.named[:1])
    return failure.case, true, sizes, missing, failure.verdict, named, ", ".join(failure.where)
