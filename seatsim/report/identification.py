"""The report of an identification: how well a model predicts a damper, and which parameters the data determine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from seatsim.identification.assessment import Agreement, Assessment
from seatsim.identification.identify import Identification
from seatsim.plots.bench.identification import PARTS, select_records
from seatsim.plots.labels import format_number, format_unit
from seatsim.report.blocks import Block, Report, Section, Table, list_notes, show_pictures
from seatsim.report.credibility.card import say_doubt, show_card
from seatsim.report.credibility.evidence import collect_identification
from seatsim.report.formatting import format_quantity, format_sentence
from seatsim.report.method import describe_method
from seatsim.report.packing import MEASURED, Panel, pack_signals
from seatsim.schema.text import join_names

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROWS = 3000
"""Most rows of a record that are drawn over time, from the stretch with the highest speed."""
GOOD, FAIR = 90.0, 75.0
"""Fits in per cent from which on a model is called good, or usable."""
METHOD = (
    "Minimised is the mean over records of the squared error of the force over the variance of the measured one: a"
    " global search on short stretches, then least squares on all records that are fitted.",
    "Fit: 100 (1 - |measured - predicted| / |measured - its mean|), in the norm over the samples; R² is of the same"
    " error; the mean deviation is |measured - predicted| over |measured|, where that is above 5 % of its peak.",
    "A parameter's ± is 1.96 standard deviations, which respect that neighbouring residuals are alike; not"
    " determined: its standard deviation is above a tenth of its size.",
)


def report_identification(found: Identification, figures: Mapping[str, Figure], command: str) -> Report:
    """Return the report of an identified damper; `command` makes it again."""
    evidence = collect_identification(found)
    chosen = select_records(found.assessments)
    sections = [
        Section("figures", "How well the force is predicted", [*show_pictures(figures, "loops"), _make_table(found)]),
        Section("signals", "Measured and predicted over time", [_show_time(chosen)]),
        Section("parameters", "Parameters", _show_parameters(found)),
        Section("notes", "Notes", list_notes([format_sentence(note) for note in found.notes])),
        show_card(evidence),
        describe_method(METHOD, command),
    ]
    about, doubt = f"Identification: {found.model}", say_doubt(evidence)
    return Report(about, _say_fit(found), [], _advise(found), sections, doubt)


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


def _make_table(found: Identification) -> Table:
    rows = [
        [
            each.record.name,
            PARTS[each.part],
            format_number(each.record.mean_current),
            *_format_agreement(each.agreement),
        ]
        for each in found.assessments
    ]
    strong = []
    for part, words in PARTS.items():
        mean = found.mean(part)
        if mean is not None:
            strong.append(len(rows))
            rows.append([f"mean, {words}", words, "", *_format_agreement(mean)])
    head = ["record", "part", "current [A]", "fit [%]", "R²", "RMS error [N]", "mean deviation"]
    return Table("Agreement of the predicted force with the measured one", head, rows, 2, strong)


def _format_agreement(found: Agreement) -> list[str]:
    figures = (found.fit_percent, found.rmse, found.md)
    fit, error, deviation = map(format_number, figures)
    return [fit, format_number(found.r2, 5), error, deviation]


def _show_time(chosen: Sequence[Assessment]) -> Block:
    names = [f"{k + 1}: {each.record.name}" for k, each in enumerate(chosen)]
    parts = [slice(*each.record.liveliest(ROWS)) for each in chosen]
    times = {name: each.record.time[part] for name, each, part in zip(names, chosen, parts, strict=True)}
    force = {
        name: [each.record.force[part], each.predicted[part]]
        for name, each, part in zip(names, chosen, parts, strict=True)
    }
    current = {name: [each.record.current[part], None] for name, each, part in zip(names, chosen, parts, strict=True)}
    panels = [Panel("damper force", "N", "", force), Panel("current", "A", "", current)]
    lines = [("measured", MEASURED), ("predicted", 1)]
    caption = "The part of each record with the highest speed."
    return pack_signals(caption, lines, times, panels)


def _show_parameters(found: Identification) -> list[Block]:
    known = found.information
    rows = [
        [each.name if each.identified else f"{each.name} (not determined)", format_unit(each.unit),
         format_number(each.value, 5), format_number(1.96 * each.std, 2)]
        for each in known.estimates
    ]  # fmt: skip
    strong = [k for k, each in enumerate(known.estimates) if not each.identified]
    head = ["parameter", "unit", "value", "±"]
    caption = "Fitted values, ± 1.96 standard deviations; in bold those that the data do not determine"
    blocks: list[Block] = [Table(caption, head, rows, 2, strong)]
    if known.correlated:
        pairs = [[first, second, format_number(value)] for first, second, value in known.correlated]
        caption = "Pairs of parameters that can replace each other"
        blocks.append(Table(caption, ["one", "other", "correlation"], pairs, 2))
    return blocks
