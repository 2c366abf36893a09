"""The report of an identification: how well a model predicts a damper, and which parameters the data determine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from seatsim.identification.assessment import Assessment
from seatsim.identification.identify import Identification
from seatsim.plots.bench.identification import PARTS, select_records
from seatsim.plots.labels import format_number, format_unit
from seatsim.report.blocks import Block, Report, Section, show_pictures, tabulate
from seatsim.report.composing import Closing, compose
from seatsim.report.credibility import Factor, count_variations, state_intervals, trace_inputs, validate
from seatsim.report.formatting import format_quantity
from seatsim.report.packing import MEASURED, Panel, pack_signals
from seatsim.schema.text import join_names

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROWS = 3000
"""Most rows of a record that are drawn over time, from the stretch with the highest speed."""
GOOD, FAIR = 90.0, 75.0
"""Fits in per cent from which on a model is called good, or usable."""


def report_identification(found: Identification, figures: Mapping[str, Figure], command: str) -> Report:
    """Return the report of an identified damper; `command` makes it again."""
    fit, chosen = [*show_pictures(figures, "loops"), *_tabulate_fit(found)], select_records(found.assessments)
    sections = [
        Section("figures", "How well the force is predicted", fit),
        Section("signals", "Measured and predicted over time", [_show_time(chosen)]),
        Section("parameters", "Parameters", _show_parameters(found)),
    ]
    about, closing = f"Identification: {found.model}", Closing(found.notes, _judge(found), command)
    return compose("identification", about, [_say_fit(found)], _advise(found), sections, closing)


def _judge(found: Identification) -> list[Factor]:
    """Return how far an identified damper may be trusted, on held-out records where there are some."""
    mean, parts = found.mean("test") or found.mean("train"), [each.part for each in found.assessments]
    error = None if mean is None else 1.0 - mean.fit_percent / 100.0
    loose = [each.name for each in found.information.estimates if not each.identified]
    return [
        validate(len(parts), parts.count("test"), error),
        trace_inputs([], [type(found.bench.damper)], True, loose),
        state_intervals(["the parameters"], True),
        count_variations(len(parts)),
    ]


def _say_fit(found: Identification) -> str:
    """Return in a sentence how well a model predicts the force, on held-out records where there are some."""
    test, train = found.mean("test"), found.mean("train")
    mean = test or train
    if mean is None:
        return f"{found.model} was fitted, but no record assesses it."
    word = "well" if mean.fit_percent >= GOOD else "usably" if mean.fit_percent >= FAIR else "poorly"
    where = "on records that took no part in the fit" if test else "on the records it was fitted to; none was held out"
    return (
        f"{found.model} predicts the damper's force {word}: a fit of {format_number(mean.fit_percent)} %, an error of"
        f" {format_quantity(mean.rmse, 'N')} RMS, {where}."
    )


def _advise(found: Identification) -> list[str]:
    texts = []
    loose = [each.name for each in found.information.estimates if not each.identified]
    if found.mean("test") is None:
        texts.append("Hold out records with --test, or the last part of each with --test-fraction, before trusting it.")
    mean = found.mean("test") or found.mean("train")
    if mean is not None and mean.fit_percent < FAIR:
        texts.append("Try other models: --model all compares them on the same records.")
    if loose:
        texts.append(f"The data do not determine {join_names(loose)}: fix them with --fix, or record other motions.")
    texts.append("Copy the sections damper and actuator of parameters.yaml into a scenario, and run it.")
    return texts


def _tabulate_fit(found: Identification) -> list[Block]:
    every = found.assessments
    judged = [(each.record.name, PARTS[each.part], each.record.mean_current, each.agreement) for each in every]
    means = [(f"mean, {words}", words, "", mean) for part, words in PARTS.items() if (mean := found.mean(part))]
    rows = [
        (*name, agreement.fit_percent, format_number(agreement.r2, 5), agreement.rmse, agreement.md)
        for *name, agreement in [*judged, *means]
    ]
    caption = "Agreement of the predicted force with the measured one"
    head = "record, part, current [A], fit [%], R², RMS error [N], mean deviation"
    return tabulate(caption, head, rows, 2, range(len(judged), len(rows)))


def _show_time(chosen: Sequence[Assessment]) -> Block:
    times, force, current = {}, {}, {}
    for k, each in enumerate(chosen):
        name, part = f"{k + 1}: {each.record.name}", slice(*each.record.liveliest(ROWS))
        times[name] = each.record.time[part]
        force[name] = [each.record.force[part], each.predicted[part]]
        current[name] = [each.record.current[part], None]
    panels = [Panel("damper force", "N", "", force), Panel("current", "A", "", current)]
    lines = [("measured", MEASURED), ("predicted", 1)]
    return pack_signals("The part of each record with the highest speed.", lines, times, panels)


def _show_parameters(found: Identification) -> list[Block]:
    known = found.information
    rows = []
    for each in known.estimates:
        figures = (format_number(each.value, 5), format_number(1.96 * each.std, 2))
        rows.append((each.name + " (not determined)" * (not each.identified), format_unit(each.unit), *figures))
    strong = [k for k, each in enumerate(known.estimates) if not each.identified]
    caption = "Fitted values, ± 1.96 standard deviations; in bold those that the data do not determine"
    pairs = "Pairs of parameters that can replace each other"
    return [
        *tabulate(caption, "parameter, unit, value, ±", rows, 2, strong),
        *tabulate(pairs, "one, other, correlation", known.correlated, 2),
    ]
