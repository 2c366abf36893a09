"""The report of a sweep: what matters most, how often limits are exceeded, the best choices."""

from __future__ import annotations

from collections.abc import Sequence

from seatsim.metrics.table import COMFORT, TRAVEL
from seatsim.plots.sweeps import describe_column, format_level, plot_comfort
from seatsim.report.blocks import Block, Figures, Report, Table, Text, show_pictures, tabulate
from seatsim.report.composing import compose
from seatsim.report.formatting import choose_advice, explain, format_quantity, show_table
from seatsim.scenario.scenario import is_condition
from seatsim.schema.printing import format_number, format_percent, format_unit
from seatsim.sweeps.engines import FAILED, UNVERIFIED
from seatsim.sweeps.parts import Exceedance, SweepRows, find_best_choices
from seatsim.sweeps.sensitivity import Sensitivities, Sensitivity, choose_choice, choose_key

_MATTERS = 0.1
"""Share of the variance from which on a key is worth a step."""
EXPLAINED = 0.8
"""Share of the variance below which the page says how little the varied keys explain."""
MOST_LINES = 60
"""Lines of a table on the page."""
_MOST_REASONS = 8


def report_sweep(rows: SweepRows, found: Sensitivities, exceeded: Sequence[Exceedance]) -> Report:
    """Return the report of a sweep from its rows and the statistics on them."""
    figures, count = draw_figures(found, rows), rows.usable.seed.nunique()
    limits = tabulate_limits(exceeded, rows)
    seeds = explain("seeds" if count > 1 else "one_seed", count=str(count))
    settings = [*seeds, Text(f"Identity of the sweep: {rows.manifest['identity']}")]
    sections: dict[str, Sequence[Block]] = {
        "limits": [*explain("drawn" if rows.is_random else "not_drawn"), *limits] if limits else [],
        "choices": tabulate_best(rows),
        "sensitivity": _show_sensitivity(found, rows),
        "pareto": show_pictures(figures, "comfort"),
        "states": _show_states(rows),
    }
    states = {state: int((rows.every.state == state).sum()) for state in (FAILED, UNVERIFIED)}
    out = " and ".join(f"{count} {state}" for state, count in states.items() if count)
    ended = f"{len(rows.every)} of {rows.manifest['counts']['runs']} runs have ended."
    left = f" {out}: these take no part in any figure." if out else ""
    answer = [*state_importance(found, rows), f"{ended}{left}"]
    about, command = f"Sweep: {rows.folder.name}", f"seatsim sweep-report {rows.folder.name}"
    return compose("sweep", about, answer, _advise(found, exceeded, rows), sections, [], command, settings)


def state_importance(found: Sensitivities, rows: SweepRows) -> list[str]:
    """Return in a few sentences which key matters most to comfort, or to the first metric that varies."""
    here = found.leading
    chosen = choose_key(here, rows)
    if chosen is None:
        return [f"Which key matters most cannot be said: {found.problem or 'no key but the variant varies'}."]
    words = describe_column(chosen.metric, rows.units).words
    what = "tolerances" if rows.drawn and not any(map(is_condition, rows.drawn)) else "varied keys"
    many = len(rows.drawn or [row for row in here if row.key != "variant"])
    first = max(here, key=lambda row: row.total)
    lead = [f"{first.key} explains {format_percent(first.total)} of the variance of the {words}."]
    total, low, high = map(format_percent, (chosen.total, chosen.total_low, chosen.total_high))
    said = f"{chosen.key}, the only one of the {what}, explains {total} of the variance of the {words}"
    if many > 1:
        said = f"Of {many} {what} {chosen.key} matters most to the {words}: it explains {total} of the variance"
    said += f" together with its interactions (95 % interval {low} to {high})."
    texts = [*lead * (first is not chosen), said]
    if (choice := choose_choice(here, rows) if is_condition(chosen.key) else None) is not None:
        share = format_percent(choice.total)
        texts.append(f"It is a condition; of the choices {choice.key} matters most and explains {share}.")
    return texts


def advise_on_keys(found: Sequence[Sensitivity], rows: SweepRows) -> list[str]:
    """Return what to do about the strongest choice."""
    texts = []
    if (choice := choose_choice(found, rows)) is not None:
        share = f"of the choices it explains the most of the variance, {format_percent(choice.total)}"
        lead = f"{'Tighten the tolerance of' if choice.key in rows.drawn else 'Settle'} {choice.key} first"
        lead = f"Leave {choice.key} as it is, and the other varied choices" if choice.total < _MATTERS else lead
        texts.append(f"{lead}: {share}.")
    return texts


def tabulate_best(rows: SweepRows) -> list[Table]:
    """Return the most comfortable choice under each condition, the worst condition first; nothing of random points."""
    keys, best = find_best_choices(rows)
    if best is None:
        return []
    shown = best.head(MOST_LINES).itertuples(index=False, name=None)
    lines = [[*map(format_level, line[:-1]), format_number(float(line[-1]))] for line in shown]
    left = len(best) - len(lines)
    others = f"; and {left} other conditions" if left else ""
    caption = f"Most comfortable choice under each condition, the worst condition first{others}"
    return tabulate(caption, [*keys, describe_column(COMFORT, rows.units).axis], lines, len(keys))


def _advise(found: Sensitivities, exceeded: Sequence[Exceedance], rows: SweepRows) -> list[str]:
    texts = []
    worst = max(exceeded, key=lambda row: row.share, default=None)
    if worst is not None and worst.share > 0:
        where = ", ".join(str(value) for value in worst.group.values())
        words = describe_column(worst.metric, rows.units).words
        limit = format_quantity(worst.limit, rows.units[worst.metric])
        above = f"{worst.exceeding} of {worst.runs} runs are above the limit of {limit}"
        texts.append(f"Begin with the {words}{f' of {where}' * bool(where)}: {above}.")
    resume = len(rows.every) < rows.manifest["counts"]["runs"]
    return [*texts, *advise_on_keys(found.leading, rows), *choose_advice(resume=resume)]


def _list_metrics(found: Sensitivities, rows: SweepRows) -> list[str]:
    """Return the metrics whose sensitivities are shown: comfort, travel and each limited one, or else the first."""
    known = dict.fromkeys(name for name in (COMFORT, TRAVEL, *rows.manifest["limits"]) if found.of(name))
    return list(known) or [row.metric for row in found.leading[:1]]


def draw_figures(found: Sensitivities, rows: SweepRows) -> Figures:
    """Return the figures of a sweep by name."""
    order = dict.fromkeys([*(row.key for row in found.leading), *rows.keys])
    figure = plot_comfort(rows, list(order))
    return {} if figure is None else {"comfort": figure}


def _show_sensitivity(found: Sensitivities, rows: SweepRows) -> list[Block]:
    """Return of comfort, travel and each limited metric the shares of variance, and how far each key moves the mean."""
    if not found.rows:
        return [Text(f"{found.problem[0].upper()}{found.problem[1:]}.")]
    blocks: list[Block] = []
    for metric in _list_metrics(found, rows):
        shown, shares = describe_column(metric, rows.units), found.of(metric)
        swings = [
            (
                *(row.key, format_percent(row.first), format_percent(row.total)),
                f"{format_percent(row.total_low)} to {format_percent(row.total_high)}",
                *(format_level(row.low), format_level(row.high), format_unit(rows.units.get(row.key) or "-")),
                *(shown.factor * row.at_low, shown.factor * row.at_high),
            )
            for row in shares[:MOST_LINES]
        ]
        blocks += show_table("swings", swings, metric=shown.axis)
        explained, words = shares[0].explained, shown.words
        if explained < EXPLAINED:
            blocks += explain("polynomial", known=format_percent(max(0.0, explained)), words=words)
    return blocks


def tabulate_limits(exceeded: Sequence[Exceedance], rows: SweepRows) -> list[Table]:
    """Return how often each limit is exceeded, by group; nothing where no run has a limited metric."""
    lines, what = [], "probability" if rows.is_random else "share of the runs"
    for row in exceeded[:MOST_LINES]:
        metric = describe_column(row.metric, rows.units).words
        limit = format_quantity(row.limit, rows.units[row.metric])
        share, low, high = map(format_percent, (row.share, row.low, row.high))
        counted = (f"{row.exceeding} of {row.runs}", share, f"{low} to {high}")
        lines.append((*map(format_level, row.group.values()), metric, limit, *counted))
    head = [*rows.texts, "metric", "limit", "runs above", what, "95 % interval"]
    return tabulate("Runs above each limit", head, lines, len(rows.texts) + 1)


def _show_states(rows: SweepRows) -> list[Table]:
    doubtful = rows.every[rows.every.state.isin((FAILED, UNVERIFIED))]
    reasons = doubtful.groupby(["state", "reason"]).run.agg(["size", "first"]).sort_values("size", ascending=False)
    counted = reasons.head(_MOST_REASONS).itertuples(name=None)
    lines = [(state, str(count), str(first), reason) for (state, reason), count, first in counted]
    return show_table("states", lines, 4)
