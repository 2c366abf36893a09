"""The report of a sweep: what matters most, how often limits are exceeded, comfort against travel, quantiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatsim.report.blocks import Bar, Bars, Block, Report, Section, Table, Text
from seatsim.report.credibility.card import show_card
from seatsim.report.credibility.evidence import collect_sweep
from seatsim.report.formatting import format_number, format_percent
from seatsim.report.method import describe_method
from seatsim.report.rendering import write_html
from seatsim.report.sweep_names import COMFORT, TRAVEL, describe_column, format_level
from seatsim.report.sweep_pictures import draw_pareto, tabulate_maps
from seatsim.sweeps.outcome import FAILED, UNVERIFIED
from seatsim.sweeps.statistics.exceedance import Exceedance
from seatsim.sweeps.statistics.inputs import SweepRows
from seatsim.sweeps.statistics.quantiles import NAMES
from seatsim.sweeps.statistics.sensitivity import Sensitivities, Sensitivity, choose_key

if TYPE_CHECKING:
    import pandas as pd

SHOWN = (COMFORT, "driver_vdv", "seat_factor", TRAVEL, "suspension_displacement_peak", "end_stop_hits", "current_rms")
"""Metrics of the tables of the page; `table.csv` has all of them."""
MOST_LINES = 60
"""Lines of a table on the page."""
MOST_KEYS = 14
MOST_REASONS = 8
ENOUGH = 0.8
"""Share of the variance that an expansion must predict before nothing is said about it."""
METHOD = (
    "All runs have the seed of the scenario, to which a replicate adds its number.",
    "Failed and unverified runs take no part in any figure.",
    "Shares of variance are Sobol indices of a polynomial chaos expansion, with 95 % intervals by resampling the runs;"
    " they assume that keys vary independently, as this design has them.",
    "Shares of runs above a limit have Wilson's interval of 95 %.",
)


def write_sweep_report(
    rows: SweepRows, quantiles: pd.DataFrame, found: Sensitivities, exceeded: Sequence[Exceedance], path: Path
) -> Path:
    """Write the report of a sweep as one self-contained HTML file, whole or not at all; return its path.

    Raises:
        InputError: the folder or the file cannot be written.
    """
    return write_html(report_sweep(rows, quantiles, found, exceeded), path)


def report_sweep(
    rows: SweepRows, quantiles: pd.DataFrame, found: Sensitivities, exceeded: Sequence[Exceedance]
) -> Report:
    """Return the report of a sweep from its rows and the statistics on them."""
    sections = [
        Section("limits", "How often limits are exceeded", _show_limits(exceeded, rows)),
        Section("sensitivity", "What matters most", _show_sensitivity(found, rows)),
        Section("pareto", "Comfort and travel", draw_pareto(rows, _order(found, rows))),
        Section("maps", "Over two keys", tabulate_maps(rows, _order(found, rows))),
        Section("quantiles", "Quantiles", _show_quantiles(quantiles, rows)),
        Section("states", "Failed and unverified runs", _show_states(rows)),
        show_card(collect_sweep(rows, found, exceeded)),
        describe_method(METHOD, {"identity": rows.manifest["identity"]}, f"seatsim sweep-report {rows.folder.name}"),
    ]
    about = f"Sweep: {rows.folder.name}"
    return Report(about, state_importance(found, rows), [_count_runs(rows)], _advise(found, exceeded, rows), sections)


def state_importance(found: Sensitivities, rows: SweepRows) -> str:
    """Return in one sentence which key matters most to comfort, or to the first metric that varies."""
    here = found.of(_main_metric(found)) if found.rows else []
    chosen = choose_key(here, rows)
    if chosen is None:
        return f"Which key matters most cannot be said: {found.problem or 'no key but the variant varies'}."
    words = describe_column(chosen.metric, rows.units).words
    what = "tolerances" if rows.drawn else "varied keys"
    many = len(rows.drawn or [row for row in here if row.key != "variant"])
    total, alone = format_percent(chosen.total), format_percent(chosen.first)
    interval = f"95 % interval {format_percent(chosen.total_low)} to {format_percent(chosen.total_high)}"
    if many > 1:
        said = f"Of {many} {what} {chosen.key} matters most to {words}: it explains {total} of its variance"
    else:
        said = f"{chosen.key}, the only one of the {what}, explains {total} of the variance of {words}"
    return f"{said} with its interactions ({interval}), {alone} alone."


def _count_runs(rows: SweepRows) -> str:
    counts: Mapping[str, int] = rows.manifest["counts"]
    states = {state: int((rows.every.state == state).sum()) for state in (FAILED, UNVERIFIED)}
    return (
        f"{len(rows.every)} of {counts['runs']} runs have ended; {states[FAILED]} of them failed and"
        f" {states[UNVERIFIED]} are unverified, which take no part in any figure."
    )


def _advise(found: Sensitivities, exceeded: Sequence[Exceedance], rows: SweepRows) -> list[str]:
    texts = []
    worst = max(exceeded, key=lambda row: row.share, default=None)
    if worst is not None and worst.share > 0:
        who = "".join(f" with {value}" for value in worst.group.values())
        words = describe_column(worst.metric, rows.units).words
        texts.append(f"Look at {words}{who} first: {format_percent(worst.share)} of the runs are above the limit.")
    chosen = choose_key(found.of(_main_metric(found)), rows) if found.rows else None
    if chosen is not None:
        verb = "Tighten the tolerance of" if rows.drawn else "Settle"
        texts.append(f"{verb} {chosen.key} before any other key: what is gained elsewhere is smaller.")
    if len(rows.every) < rows.manifest["counts"]["runs"]:
        texts.append("Go on with the sweep: seatsim sweep with --resume.")
    return texts


def _main_metric(found: Sensitivities) -> str:
    metrics = dict.fromkeys(row.metric for row in found.rows)
    return COMFORT if COMFORT in metrics else next(iter(metrics))


def _order(found: Sensitivities, rows: SweepRows) -> list[str]:
    """Return the varied keys, what matters most to comfort first."""
    ranked = [row.key for row in found.of(_main_metric(found))] if found.rows else []
    return [*ranked, *(key for key in rows.keys if key not in ranked)]


def _show_limits(exceeded: Sequence[Exceedance], rows: SweepRows) -> list[Block]:
    if not exceeded:
        return []
    what = "probability" if rows.is_random else "share of the runs"
    lead = (
        "Runs are taken as drawn independently of each other."
        if rows.is_random
        else "No key is drawn from a distribution: these are shares of the runs of the design, no probabilities."
    )
    head = [*exceeded[0].group, "metric", "limit", "runs above", what, "95 % interval"]
    lines = []
    for row in exceeded[:MOST_LINES]:
        shown = describe_column(row.metric, rows.units)
        limit = f"{format_number(shown.factor * row.limit)} {shown.unit}".removesuffix(" -")
        interval = f"{format_percent(row.low)} to {format_percent(row.high)}"
        lines.append([*map(format_level, row.group.values()), shown.words, limit, f"{row.exceeding} of {row.runs}",
                      format_percent(row.share), interval])  # fmt: skip
    return [Text(lead), Table("Runs above each limit", head, lines, words=len(exceeded[0].group) + 1)]


def _show_sensitivity(found: Sensitivities, rows: SweepRows) -> list[Block]:
    if not found.rows:
        return [Text(f"{found.problem[0].upper()}{found.problem[1:]}.")]
    metrics = [name for name in (COMFORT, TRAVEL, *rows.manifest["limits"]) if found.of(name)]
    blocks: list[Block] = []
    for metric in dict.fromkeys(metrics or [_main_metric(found)]):
        here = found.of(metric)
        words = describe_column(metric, rows.units).words
        blocks += [_draw_shares(here, words), _draw_tornado(here, rows)]
        if here[0].explained < ENOUGH:
            known = format_percent(max(0.0, here[0].explained))
            blocks.append(Text(f"The expansion predicts {known} of the variance of {words} of runs left out; the rest"
                               " is road, noise, or interactions that it has no terms for."))  # fmt: skip
    return blocks


def _draw_shares(found: Sequence[Sensitivity], words: str) -> Bars:
    bars = [
        Bar(row.key, 0.0, round(100 * _known(row.first), 2),
            f"{format_percent(row.first)} alone, {format_percent(row.total)} in all", "chosen" if k == 0 else "plain",
            (round(100 * _known(row.total_low), 2), round(100 * _known(row.total_high), 2)))
        for k, row in enumerate(found[:MOST_KEYS])
    ]  # fmt: skip
    cut = f" The {MOST_KEYS} strongest of {len(found)} keys." if len(found) > MOST_KEYS else ""
    caption = f"Bar: share of the variance by the key alone; line: 95 % interval of its share with interactions.{cut}"
    return Bars(f"What {words} hangs on", caption, "key", bars)


def _draw_tornado(found: Sequence[Sensitivity], rows: SweepRows) -> Bars:
    """Return from where to where the mean of a metric goes between a low and a high value of each key."""
    shown, strongest = describe_column(found[0].metric, rows.units), found[:MOST_KEYS]
    means = [mean for row in strongest for mean in (row.at_low, row.at_high)]
    least, scale = min(means), 100 / ((max(means) - min(means)) or 1.0)
    bars = []
    for row in strongest:
        start, end = sorted(round(scale * (mean - least), 2) for mean in (row.at_low, row.at_high))
        ends = ((row.low, row.at_low), (row.high, row.at_high))
        texts = [f"{format_number(shown.factor * mean)} at {format_level(level)}" for level, mean in ends]
        unit = rows.units.get(row.key, "")
        bars.append(Bar(row.key, start, end, f"{texts[0]}, {texts[1]} {unit}".rstrip(" -")))
    caption = "Between the 5 % and the 95 % quantile of each key; of a text, between its least and its greatest mean."
    return Bars(f"How far each key moves the mean of {shown.axis}", caption, "key", bars)


def _known(value: float) -> float:
    return min(1.0, max(0.0, value)) if np.isfinite(value) else 0.0


def _show_quantiles(quantiles: pd.DataFrame, rows: SweepRows) -> list[Block]:
    groups = rows.texts
    figures = ["mean", "min", *NAMES, "max"]
    lines = []
    for record in quantiles[quantiles.metric.isin(SHOWN)].head(MOST_LINES).to_dict("records"):
        shown = describe_column(str(record["metric"]), rows.units)
        names = [format_level(record[key]) for key in groups]
        values = [format_number(shown.factor * float(record[name])) for name in figures]
        lines.append([*names, shown.words, shown.unit, str(record["runs"]), *values])
    head = [*groups, "metric", "unit", "runs", "mean", "least", "5 %", "25 %", "median", "75 %", "95 %", "greatest"]
    caption = "Over the runs of each group; table.csv has every metric"
    return [Table(caption, head, lines, words=len(groups) + 2)] if lines else []


def _show_states(rows: SweepRows) -> list[Block]:
    doubtful = rows.every[rows.every.state.isin((FAILED, UNVERIFIED))]
    reasons = doubtful.groupby(["state", "reason"]).run.agg(["size", "first"]).sort_values("size", ascending=False)
    lines = [
        [state, str(count), str(first), reason] for (state, reason), (count, first) in
        zip(reasons.index[:MOST_REASONS], reasons.to_numpy()[:MOST_REASONS], strict=True)
    ]  # fmt: skip
    return [Table("Reasons, the most frequent first", ["state", "runs", "first run", "reason"], lines, 4)] * bool(lines)
