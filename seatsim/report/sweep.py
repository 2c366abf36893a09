"""The report of a sweep: what matters most, how often limits are exceeded, comfort against travel, quantiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.plots.frame import Picture
from seatsim.plots.sweeps.heat_map import plot_heat_map
from seatsim.plots.sweeps.naming import describe_column, format_level
from seatsim.plots.sweeps.pareto import COMFORT, TRAVEL, plot_pareto
from seatsim.plots.sweeps.tornado import plot_tornado
from seatsim.report.document import FilledSection, render_document
from seatsim.report.formatting import format_percent
from seatsim.report.html import Html, embed_pictures, join, make_list, make_table, tag
from seatsim.schema.files import write_text
from seatsim.sweeps.outcome import FAILED, UNVERIFIED
from seatsim.sweeps.statistics.exceedance import Exceedance
from seatsim.sweeps.statistics.inputs import SweepRows
from seatsim.sweeps.statistics.quantiles import NAMES
from seatsim.sweeps.statistics.sensitivity import Sensitivities, choose_key

if TYPE_CHECKING:
    import pandas as pd

SHOWN = (COMFORT, "driver_vdv", "seat_factor", TRAVEL, "suspension_displacement_peak", "end_stop_hits", "current_rms")
"""Metrics of the tables of the page; `table.csv` has all of them."""
MOST_LINES = 60
"""Lines of a table on the page."""
MOST_REASONS = 8
ENOUGH = 0.8
"""Share of the variance that an expansion must predict before nothing is said about it."""


def write_sweep_report(
    rows: SweepRows, quantiles: pd.DataFrame, found: Sensitivities, exceeded: Sequence[Exceedance], path: Path
) -> Path:
    """Write the report of a sweep as one self-contained HTML file, whole or not at all; return its path.

    Raises:
        InputError: the folder or the file cannot be written.
    """
    sections = [
        FilledSection("limits", "How often limits are exceeded", _render_limits(exceeded, rows)),
        FilledSection("sensitivity", "What matters most", _render_sensitivity(found, rows)),
        FilledSection("pareto", "Comfort and travel", embed_pictures([plot_pareto(rows, _order(found, rows))])),
        FilledSection("maps", "Over two keys", embed_pictures(_plot_maps(found, rows))),
        FilledSection("quantiles", "Quantiles", _render_quantiles(quantiles, rows)),
        FilledSection("states", "Failed and unverified runs", _render_states(rows)),
    ]
    sentence = state_importance(found, rows)
    return write_text(
        path, render_document(f"Sweep {rows.folder.name}: {sentence}", _render_head(sentence, rows), sections)
    )


def state_importance(found: Sensitivities, rows: SweepRows) -> str:
    """Return in one sentence which key matters most to comfort, or to the first metric that varies."""
    here = found.of(_main_metric(found)) if found.rows else []
    chosen = choose_key(here, rows)
    if chosen is None:
        return f"Which key matters most cannot be said: {found.problem or 'no key but the variant varies'}."
    words = describe_column(chosen.metric, rows.units).words
    what = "tolerances" if rows.drawn else "varied keys"
    many = len(rows.drawn or [row for row in here if row.key != "variant"])
    among = f"Of {many} {what} {chosen.key} matters most" if many > 1 else f"{chosen.key} is the only one of the {what}"
    return (
        f"{among} to {words}: it explains {format_percent(chosen.total)} of its variance with its interactions (95 %"
        f" interval {format_percent(chosen.total_low)} to {format_percent(chosen.total_high)}), "
        f"{format_percent(chosen.first)} alone."
    )


def _main_metric(found: Sensitivities) -> str:
    metrics = dict.fromkeys(row.metric for row in found.rows)
    return COMFORT if COMFORT in metrics else next(iter(metrics))


def _order(found: Sensitivities, rows: SweepRows) -> list[str]:
    """Return the varied keys, what matters most to comfort first."""
    ranked = [row.key for row in found.of(_main_metric(found))] if found.rows else []
    return [*ranked, *(key for key in rows.keys if key not in ranked)]


def _render_head(sentence: str, rows: SweepRows) -> Html:
    counts: Mapping[str, int] = rows.manifest["counts"]
    ended = len(rows.every)
    states = {state: int((rows.every.state == state).sum()) for state in (FAILED, UNVERIFIED)}
    facts = (
        f"{ended} of {counts['runs']} runs have ended; {states[FAILED]} of them failed and {states[UNVERIFIED]} are"
        " unverified, which take no part in any figure."
    )
    return tag(
        "header",
        tag("p", f"Sweep {rows.folder.name}, identity {rows.manifest['identity'][:12]}", class_="eyebrow"),
        tag("h1", sentence),
        tag("p", facts, class_="lead"),
    )


def _render_limits(exceeded: Sequence[Exceedance], rows: SweepRows) -> Html:
    if not exceeded:
        return Html("")
    what = "probability" if rows.is_random else "share of the runs"
    lead = (
        "Estimated from the share of runs above the limit, with its Wilson interval of 95 %, which takes runs as drawn"
        " independently of each other."
        if rows.is_random
        else "No key is drawn from a distribution: these are shares of the runs of the design, no probabilities."
    )
    head = [*exceeded[0].group, "metric", "unit", "limit", "runs above", what, "95 % interval"]
    lines = [
        [*map(format_level, row.group.values()), describe_column(row.metric, rows.units).words, row.unit,
         f"{row.limit:g}",
         f"{row.exceeding} of {row.runs}", format_percent(row.share),
         f"{format_percent(row.low)} to {format_percent(row.high)}"]
        for row in exceeded[:MOST_LINES]
    ]  # fmt: skip
    return join([tag("p", lead), make_table(head, lines, words=len(exceeded[0].group) + 2)])


def _render_sensitivity(found: Sensitivities, rows: SweepRows) -> Html:
    if not found.rows:
        return tag("p", f"{found.problem[0].upper()}{found.problem[1:]}.")
    metrics = [name for name in (COMFORT, TRAVEL, *rows.manifest["limits"]) if found.of(name)]
    pictures = [plot_tornado(found.of(metric), rows) for metric in dict.fromkeys(metrics or [_main_metric(found)])]
    poor = [
        f"{describe_column(metric, rows.units).words}: the expansion predicts"
        f" {format_percent(max(0.0, rest[0].explained))} of the variance of runs left out; the rest is road, noise, or"
        " interactions that it has no terms for."
        for metric in dict.fromkeys(metrics)
        if (rest := found.of(metric))[0].explained < ENOUGH
    ]
    lead = (
        "Shares of variance assume that keys vary independently, as this design has them; they say which tolerance to"
        " tighten first. All metrics stand in sensitivity.csv."
    )
    return join([tag("p", lead), embed_pictures(pictures), make_list(poor)])


def _plot_maps(found: Sensitivities, rows: SweepRows) -> list[Picture | None]:
    order = [key for key in _order(found, rows) if key != "variant"]
    if len(order) < 2:
        return []
    return [plot_heat_map(rows, metric, order[0], order[1]) for metric in (COMFORT, TRAVEL) if metric in rows.metrics]


def _render_quantiles(quantiles: pd.DataFrame, rows: SweepRows) -> Html:
    groups = rows.texts
    figures = ["mean", "min", *NAMES, "max"]
    chosen = quantiles[quantiles.metric.isin(SHOWN)].head(MOST_LINES)
    lines = []
    for record in chosen.to_dict("records"):
        quantity = describe_column(str(record["metric"]), rows.units)
        names = [format_level(record[key]) for key in groups]
        values = [f"{quantity.factor * float(record[name]):.4g}" for name in figures]
        lines.append([*names, quantity.words, quantity.unit, str(record["runs"]), *values])
    head = [*groups, "metric", "unit", "runs", "mean", "least", "5 %", "25 %", "median", "75 %", "95 %", "greatest"]
    return make_table(head, lines, words=len(groups) + 2) if lines else Html("")


def _render_states(rows: SweepRows) -> Html:
    doubtful = rows.every[rows.every.state.isin((FAILED, UNVERIFIED))]
    reasons = doubtful.groupby(["state", "reason"]).run.agg(["size", "first"]).sort_values("size", ascending=False)
    lines = [
        [state, str(count), str(first), reason] for (state, reason), (count, first) in
        zip(reasons.index[:MOST_REASONS], reasons.to_numpy()[:MOST_REASONS], strict=True)
    ]  # fmt: skip
    return make_table(["state", "runs", "first run", "reason"], lines, words=4) if lines else Html("")
