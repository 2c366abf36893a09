"""The report of a sweep: what matters most, how often limits are exceeded, comfort against travel, quantiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.metrics.table import METRICS
from seatsim.plots.quantities import Quantity
from seatsim.report.blocks import Bar, Bars, Block, Matrix, Report, Section, Table, Text
from seatsim.report.formatting import describe_channel, format_number, format_percent
from seatsim.report.method import describe_method
from seatsim.report.planes import Curve, draw_curves
from seatsim.report.rendering import write_html
from seatsim.sweeps.outcome import FAILED, UNVERIFIED
from seatsim.sweeps.statistics.exceedance import Exceedance
from seatsim.sweeps.statistics.inputs import SweepRows, is_number
from seatsim.sweeps.statistics.quantiles import NAMES
from seatsim.sweeps.statistics.sensitivity import Sensitivities, Sensitivity, choose_key

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_rms"
SHOWN = (COMFORT, "driver_vdv", "seat_factor", TRAVEL, "suspension_displacement_peak", "end_stop_hits", "current_rms")
"""Metrics of the tables of the page; `table.csv` has all of them."""
WORDS = {
    COMFORT: "driver, weighted RMS", TRAVEL: "RMS suspension travel",
    "suspension_displacement_peak": "peak suspension travel",
}  # fmt: skip
MOST_LINES = 60
"""Lines of a table on the page."""
MOST_KEYS = 14
MOST_REASONS = 8
MOST_POINTS = 4000
"""Runs that are drawn; more of them hide each other."""
MOST_GROUPS = 8
MOST_LEVELS = 10
"""Values of a key that have rows or columns of their own; numbers with more are taken in `BINS` of as many runs."""
BINS = 6
ENOUGH = 0.8
"""Share of the variance that an expansion must predict before nothing is said about it."""
METHOD = (
    "Every run has a seed of its own, derived from the sweep's; failed and unverified runs take no part in any figure.",
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
        Section("pareto", "Comfort and travel", _show_pareto(rows, _order(found, rows))),
        Section("maps", "Over two keys", _show_maps(found, rows)),
        Section("quantiles", "Quantiles", _show_quantiles(quantiles, rows)),
        Section("states", "Failed and unverified runs", _show_states(rows)),
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
    among = f"Of {many} {what} {chosen.key} matters most" if many > 1 else f"{chosen.key} is the only one of the {what}"
    return (
        f"{among} to {words}: it explains {format_percent(chosen.total)} of its variance with its interactions (95 %"
        f" interval {format_percent(chosen.total_low)} to {format_percent(chosen.total_high)}), "
        f"{format_percent(chosen.first)} alone."
    )


def describe_column(name: str, units: Mapping[str, str]) -> Quantity:
    """Return how a key, by its name, or a metric, in words, is shown."""
    shown = describe_channel(WORDS.get(name, name), units.get(name, ""))
    return shown if name in METRICS else shown._replace(words=name)


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


def format_level(value: object) -> str:
    """Return the value of a key as text."""
    return format_number(value, 4) if isinstance(value, float) else str(value)


def _show_sensitivity(found: Sensitivities, rows: SweepRows) -> list[Block]:
    if not found.rows:
        return [Text(f"{found.problem[0].upper()}{found.problem[1:]}.")]
    metrics = [name for name in (COMFORT, TRAVEL, *rows.manifest["limits"]) if found.of(name)]
    blocks: list[Block] = []
    for metric in dict.fromkeys(metrics or [_main_metric(found)]):
        here = found.of(metric)
        words = describe_column(metric, rows.units).words
        blocks += [_draw_shares(here, words), _list_swings(here, rows)]
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


class Swing(NamedTuple):
    """A value of a key and the mean of a metric there."""

    level: object
    mean: float


def _list_swings(found: Sequence[Sensitivity], rows: SweepRows) -> Table:
    shown = describe_column(found[0].metric, rows.units)
    lines = []
    for row in found[:MOST_KEYS]:
        ends = (Swing(row.low, row.at_low), Swing(row.high, row.at_high))
        values = [text for end in ends for text in (format_level(end.level), format_number(shown.factor * end.mean))]
        lines.append([row.key, rows.units.get(row.key, ""), *values])
    head = ["key", "unit", "low value", "mean there", "high value", "mean there"]
    caption = f"Mean of {shown.axis} at the 5 % and the 95 % quantile of each key (of a text: least and greatest mean)"
    return Table(caption, head, lines, 2)


def _known(value: float) -> float:
    return min(1.0, max(0.0, value)) if np.isfinite(value) else 0.0


def _show_pareto(rows: SweepRows, order: Sequence[str]) -> list[Block]:
    """Return comfort over travel, coloured by a text, or by the lower and upper values of what matters most."""
    if not {COMFORT, TRAVEL} <= set(rows.metrics):
        return []
    shown = rows.usable.dropna(subset=[COMFORT, TRAVEL])
    drawn = shown.sample(MOST_POINTS, random_state=0) if len(shown) > MOST_POINTS else shown
    key = next((key for key in order if drawn[key].nunique() <= MOST_GROUPS), None)
    groups = [("runs", drawn)] if key is None else [
        (f"{key} {format_level(value)}", drawn[drawn[key] == value]) for value in sorted(drawn[key].unique())
    ]  # fmt: skip
    curves = [
        Curve(name, 1e3 * part[TRAVEL].to_numpy(float), part[COMFORT].to_numpy(float), (k + 1) % 8, "dots")
        for k, (name, part) in enumerate(groups)
    ]
    travel, comfort = shown[TRAVEL].to_numpy(float), shown[COMFORT].to_numpy(float)
    front = find_front(travel, comfort)
    curves.append(Curve("Pareto front", 1e3 * travel[front], comfort[front], 0))
    some = f" {len(drawn)} of {len(shown)} runs are drawn." if len(drawn) < len(shown) else ""
    axes = ("RMS suspension travel [mm]", "driver, weighted RMS [m/s²]")
    return [draw_curves("Comfort against travel", f"A point for each run; lower left is better.{some}", axes, curves)]


def find_front(travel: Array, comfort: Array) -> NDArray[np.intp]:
    """Return the indices of the runs that no other is better than in both, by rising travel."""
    order = np.lexsort((comfort, travel))
    best = np.minimum.accumulate(comfort[order])
    keep = np.concatenate([[True], comfort[order][1:] < best[:-1]])
    front: NDArray[np.intp] = order[keep]
    return front


def _show_maps(found: Sensitivities, rows: SweepRows) -> list[Block]:
    order = [key for key in _order(found, rows) if key != "variant"]
    if len(order) < 2:
        return []
    maps = [_tabulate(rows, metric, order[0], order[1]) for metric in (COMFORT, TRAVEL) if metric in rows.metrics]
    return [each for each in maps if each is not None]


def _tabulate(rows: SweepRows, metric: str, across: str, up: str) -> Matrix | None:
    """Return the mean of a metric over two keys, or None where one of them is a text with too many values."""
    import pandas as pd

    x, y = (_group(rows.usable[key]) for key in (across, up))
    if x is None or y is None:
        return None
    shown = describe_column(metric, rows.units)
    means = pd.DataFrame({"x": x, "y": y, "z": shown.factor * rows.usable[metric]})
    table = means.groupby(["y", "x"], observed=True)["z"].mean().unstack()
    values = table.to_numpy()
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    lines = [
        (str(name), [
            (format_number(value), min(9, int(10 * (value - low) / ((high - low) or 1.0)))) if np.isfinite(value)
            else ("", 0) for value in line
        ])
        for name, line in zip(table.index, values, strict=True)
    ]  # fmt: skip
    caption = f"Mean over the runs of each cell, in {shown.unit}; the darker, the larger."
    title = f"{shown.words} over {across} (columns) and {up} (rows)"
    return Matrix(f"{title[:1].upper()}{title[1:]}", caption, up, [str(name) for name in table.columns], lines)


def _group(values: pd.Series) -> pd.Series | None:
    """Return the values as ordered names of cells."""
    import pandas as pd

    if values.nunique() <= MOST_LEVELS:
        names = pd.Categorical(values.map(format_level), [format_level(x) for x in sorted(values.unique())], True)
        return pd.Series(names, index=values.index)
    if not is_number(values):
        return None
    cells = pd.qcut(values, BINS, duplicates="drop")
    return cells.cat.rename_categories([f"{c.left:.3g} to {c.right:.3g}" for c in cells.cat.categories])


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
