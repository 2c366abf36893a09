"""A score as tables for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.table import Table

from seatsim.blind.score.cases import Rate
from seatsim.blind.score.score import Score


def tables(score: Score, width: int = 12) -> list[Table]:
    """Return the tables of a score, the summary first; `width` bounds the list of failures."""
    return [
        _summary(score),
        _rates("by effect", score.effects),
        _confusion(score),
        _reliability(score),
        *([_found_sizes(score)] if score.found_sizes else []),
        _failures(score, width),
    ]


def _table(title: str, *headings: str) -> Table:
    table = Table(title=title, title_justify="left")
    for n, heading in enumerate(headings):
        table.add_column(heading, justify="left" if n == 0 else "right")
    return table


def _row(rate: Rate) -> tuple[str, str, str]:
    low, high = rate.interval
    return f"{rate.value:.3f}", f"{rate.right}/{rate.total}", f"{low:.2f}-{high:.2f}"


def _summary(score: Score) -> Table:
    table = _table(f"blind score, {score.cases} cases", "what", "share", "count", "95 % interval")
    named = {"right": score.right} | {f"right: {kind}": value for kind, value in score.kinds.items()}
    named |= {
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
    for name, value in named.items():
        if value.total:
            table.add_row(name, *_row(value))
    if score.untouched:
        said = ", ".join(f"{name} {count}" for name, count in score.untouched.items())
        table.add_row("untouched carriers (not scored)", said, str(sum(score.untouched.values())), "")
    table.add_section()
    table.add_row("calibration error (ECE)", f"{score.calibration_error:.4f}", "", "")
    table.add_row("Brier", f"{score.brier:.4f}", "", "")
    table.add_row("mean group size", f"{score.group_size:.2f}", "", "")
    if score.shrink is not None:
        for word, shrink in (("stated", score.shrink), ("predicted", score.shrink.predicted)):
            if shrink is not None:
                table.add_row(f"shrink: |{word} - true|", f"{shrink.mean_difference:.3f}", str(len(shrink.cases)), "")
                table.add_row(f"shrink: {word} - true", f"{shrink.bias:+.3f}", "", "")
                table.add_row(f"shrink: interval {word} covers", *_row(shrink.coverage))
    return table


def _rates(title: str, rates: Mapping[str, Rate]) -> Table:
    table = _table(title, "effect", "share", "count", "95 % interval")
    for name, value in rates.items():
        table.add_row(name, *_row(value))
    return table


def _confusion(score: Score) -> Table:
    table = _table("what was named", "truth")
    table.add_column("named (times)")
    for truth, named in score.confusion.items():
        table.add_row(truth, ", ".join(f"{name} {count}" for name, count in named.items()))
    return table


def _reliability(score: Score) -> Table:
    table = _table("reliability of the marginal probabilities", "from - to", "stated", "true", "count")
    for part in score.reliability:
        table.add_row(f"{part.low:.4f} - {part.high:.4f}", f"{part.stated:.4f}", f"{part.true:.4f}", str(part.count))
    return table


def _found_sizes(score: Score) -> Table:
    table = _table("sizes of effects that were found", "case", "effect", "parameter", "true", "found")
    for size in score.found_sizes:
        table.add_row(size.case, size.effect, size.parameter, f"{size.true:.4g}", f"{size.found:.4g}")
    return table


def _failures(score: Score, width: int) -> Table:
    table = _table("failures", "case", "truth", "limit x", "missing", "verdict", "named", "where")
    for failure in score.failures[:width]:
        true = ", ".join(failure.effects) or ", ".join(failure.forms) or "none"
        sizes = ", ".join(f"{size:.1f}" for size in failure.materialities)
        named = ", ".join(failure.selected or failure.named[:1])
        table.add_row(
            failure.case,
            true,
            sizes,
            ", ".join(failure.missing),
            failure.verdict,
            named,
            ", ".join(failure.where),
        )
    if len(score.failures) > width:
        table.add_row(f"and {len(score.failures) - width} more", *[""] * 6)
    return table
