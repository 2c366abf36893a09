"""Evidence for the answer: signals, spectra, maps, the model discrepancy, comfort figures, notes."""

from __future__ import annotations

import math

from seatsim.diagnosis.result import Diagnosis
from seatsim.plots import labels
from seatsim.plots.diagnosis.discrepancy import plot_discrepancy
from seatsim.plots.diagnosis.maps import plot_maps
from seatsim.plots.diagnosis.signals import plot_signals, plot_spectra
from seatsim.plots.frame import FACTORS
from seatsim.report.formatting import UNKNOWN, format_sentence
from seatsim.report.html import Html, embed_pictures, join, make_list, make_table, tag
from seatsim.schema.text import join_names

COMMAND = "seatsim gap augmented.yaml OTHER_RECORDING"


def render_signals(diagnosis: Diagnosis) -> Html:
    """Return the windows of the held-out signals in which the nominal simulation is most wrong."""
    return embed_pictures(plot_signals(diagnosis))


def render_spectra(diagnosis: Diagnosis) -> Html:
    """Return the spectra of the residuals."""
    return embed_pictures(plot_spectra(diagnosis))


def render_maps(diagnosis: Diagnosis) -> Html:
    """Return the maps of the residual over the operating range."""
    return embed_pictures(plot_maps(diagnosis))


def render_discrepancy(diagnosis: Diagnosis) -> Html:
    """Return the discrepancy that would close the gap, described and drawn, where the cause is unknown."""
    found = diagnosis.evidence.discrepancy
    if found is None:
        return Html("")
    lead = f"What would close the gap in the {found.block}, estimated from the recording."
    return join(
        [
            tag("p", lead, class_="lead"),
            make_list(format_sentence(text) for text in found.description),
            embed_pictures(plot_discrepancy(diagnosis)),
        ]
    )


def render_comfort(diagnosis: Diagnosis) -> Html:
    """Return the table of comfort and travel on held-out runs, the figures by which seats are assessed."""
    if not diagnosis.evidence.comfort:
        return Html("")
    rows = [_make_comfort_row(*row) for row in diagnosis.evidence.comfort]
    last = "with effects" if diagnosis.selected else "refitted"
    return make_table(["held-out runs", "unit", "measured", "nominal", "error", last, "error"], rows, words=2)


def render_budget(diagnosis: Diagnosis) -> Html:
    """Return what the error of the stated scenario is made of on the held-out run, by channel."""
    if not diagnosis.error_budget:
        return Html("")
    lead = (
        "Comparison error E of the scenario stated, in the terms of ASME V&V 20, as RMS: u_num from halving the step of"
        " the integration, u_input from the noise of the recorded inputs, u_D the noise of the sensor; what these leave"
        " is the error of the model's form."
    )
    head = ["channel", "unit", "E", "u_num", "u_input", "u_D", "model form"]
    rows = [_make_budget_row(*row) for row in diagnosis.error_budget]
    return join([tag("p", lead, class_="lead"), make_table(head, rows, words=2)])


def render_notes(diagnosis: Diagnosis) -> Html:
    """Return notes on the data, and the groups of blocks that the recorded channels can tell apart."""
    sentences = [format_sentence(note) for note in diagnosis.notes]
    if diagnosis.held_out:
        sentences.append(f"Held out, no part of any fit: {join_names(diagnosis.held_out)}.")
    groups = [group for group in diagnosis.isolable if group]
    if groups:
        merged = [join_names(group, "or") for group in groups if len(group) > 1]
        text = (
            f"These channels can distinguish these groups of blocks: {'; '.join(join_names(g, 'or') for g in groups)}."
        )
        mind = " Within a group only the form of an effect can." if merged else ""
        sentences.append(text + mind)
    return make_list(sentences)


def render_use(diagnosis: Diagnosis) -> Html:
    """Return how the result is checked on another recording."""
    what = "the refitted parameters and the effects found" if diagnosis.selected else "the refitted parameters"
    return join(
        [
            tag("p", tag("code", "augmented.yaml"), f" is the nominal scenario with {what}. It runs like any scenario;"
                " this measures its gap on a recording that the diagnosis has not seen:"),
            tag("pre", tag("code", COMMAND)),
        ]
    )  # fmt: skip


def _make_comfort_row(quantity: str, unit: str, measured: float, nominal: float, after: float) -> list[str]:
    factor, shown = FACTORS.get(unit, (1.0, labels.format_unit(unit)))
    return [
        quantity.replace("_", " "), shown, _format_number(factor * measured), _format_number(factor * nominal),
        _format_error(nominal, measured), _format_number(factor * after), _format_error(after, measured),
    ]  # fmt: skip


def _make_budget_row(channel: str, unit: str, *parts: float) -> list[str]:
    factor, shown = FACTORS.get(unit, (1.0, labels.format_unit(unit)))
    return [channel.replace("_", " "), shown, *(_format_number(factor * part) for part in parts)]


def _format_number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else UNKNOWN


def _format_error(value: float, truth: float) -> str:
    if not math.isfinite(value) or not math.isfinite(truth) or truth == 0:
        return UNKNOWN
    return f"{100 * (value / truth - 1):+.1f} %".replace("-", "−")
