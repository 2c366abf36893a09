"""What the answer rests on: signals, spectra, maps, the course of what is missing, comfort, notes."""

from __future__ import annotations

import math

from seatsim.diagnosis.result import Diagnosis
from seatsim.plots import labels
from seatsim.plots.diagnosis.discrepancy import latent
from seatsim.plots.diagnosis.frame import FACTORS
from seatsim.plots.diagnosis.maps import maps
from seatsim.plots.diagnosis.signals import signals, spectra
from seatsim.report.html import Html, bullets, joined, pictures, table, tag
from seatsim.report.words import UNKNOWN, listed, sentence

COMMAND = "seatsim gap augmented.yaml OTHER_RECORDING"


def before_and_after(diagnosis: Diagnosis) -> Html:
    """Return the most telling windows of the held-out signals."""
    return pictures(signals(diagnosis))


def frequencies(diagnosis: Diagnosis) -> Html:
    """Return the spectra of what is left."""
    return pictures(spectra(diagnosis))


def ranges(diagnosis: Diagnosis) -> Html:
    """Return the maps over the operating range."""
    return pictures(maps(diagnosis))


def missing(diagnosis: Diagnosis) -> Html:
    """Return what would close the gap, described and drawn, where the cause is unknown."""
    found = diagnosis.evidence.discrepancy
    if found is None:
        return Html("")
    lead = f"What would close the gap in the {found.block}, estimated from the recording."
    return joined(
        [
            tag("p", lead, class_="lead"),
            bullets(sentence(text) for text in found.description),
            pictures(latent(diagnosis)),
        ]
    )


def comfort(diagnosis: Diagnosis) -> Html:
    """Return the figures that seat people quote."""
    if not diagnosis.evidence.comfort:
        return Html("")
    rows = [_comfort_row(*row) for row in diagnosis.evidence.comfort]
    last = "with effects" if diagnosis.selected else "refitted"
    return table(["held-out runs", "unit", "measured", "nominal", "error", last, "error"], rows, words=2)


def notes(diagnosis: Diagnosis) -> Html:
    """Return what is to be said about the data, and what these channels can tell apart."""
    sentences = [sentence(note) for note in diagnosis.notes]
    if diagnosis.held_out:
        sentences.append(f"Held out, no part of any fit: {listed(diagnosis.held_out)}.")
    groups = [group for group in diagnosis.isolable if group]
    if groups:
        merged = [listed(group, "or") for group in groups if len(group) > 1]
        text = f"These channels can tell these groups of blocks apart: {'; '.join(listed(g, 'or') for g in groups)}."
        mind = " Within a group only the form of an effect can." if merged else ""
        sentences.append(text + mind)
    return bullets(sentences)


def use(diagnosis: Diagnosis) -> Html:
    """Return how the claim is checked elsewhere."""
    what = "the refitted parameters and the effects found" if diagnosis.selected else "the refitted parameters"
    return joined(
        [
            tag("p", tag("code", "augmented.yaml"), f" is the nominal scenario with {what}. It runs like any scenario;"
                " this measures its gap on a recording that the diagnosis has not seen:"),
            tag("pre", tag("code", COMMAND)),
        ]
    )  # fmt: skip


def _comfort_row(quantity: str, unit: str, measured: float, nominal: float, after: float) -> list[str]:
    factor, shown = FACTORS.get(unit, (1.0, labels.unit(unit)))
    return [
        quantity.replace("_", " "), shown, _number(factor * measured), _number(factor * nominal),
        _error(nominal, measured), _number(factor * after), _error(after, measured),
    ]  # fmt: skip


def _number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else UNKNOWN


def _error(value: float, truth: float) -> str:
    if not math.isfinite(value) or not math.isfinite(truth) or truth == 0:
        return UNKNOWN
    return f"{100 * (value / truth - 1):+.1f} %".replace("-", "−")
