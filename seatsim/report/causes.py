"""Which effect: probabilities, parameters, what cannot be told apart, and what would tell it."""

from __future__ import annotations

from collections.abc import Iterator

from seatsim.diagnosis.result import Cause, Diagnosis
from seatsim.plots.diagnosis.answer import MOST, ranking, where
from seatsim.plots.diagnosis.collinearity import alikeness
from seatsim.report.html import Html, bullets, joined, pictures, table, tag
from seatsim.report.words import estimate, listed, meaning, percent, plain, sentence

LIKELY = 0.05
"""Probability from which on the parameters of a cause are printed."""


def ranked(diagnosis: Diagnosis) -> Html:
    """Return where the gap lies, which effects may cause it, and their parameters."""
    left = joined([pictures([where(diagnosis)]), _parameters(diagnosis)])
    return tag("div", tag("div", left), pictures([ranking(diagnosis)]), class_="beside")


def confusions(diagnosis: Diagnosis) -> Html:
    """Return what could be taken for what, in sentences and as a heat map."""
    sentences = [
        f"This recording cannot tell {listed([f'{name}' for name in group])} apart: each explains the gap as well."
        for group in diagnosis.indistinguishable
        if len(group) > 1
    ]
    decides, alike = _experiment(diagnosis), pictures([alikeness(diagnosis)])
    lead = [tag("p", text, class_="lead") for text in sentences]
    return joined([*lead, tag("div", alike, decides, class_="beside")]) if lead or decides or alike else Html("")


def _experiment(diagnosis: Diagnosis) -> Html:
    """Return the experiment that would decide, as it is described."""
    found = diagnosis.experiment
    if found is None:
        return Html("")
    now, then = plain(found.likeness_now), plain(found.likeness_then)
    rows = [("kind", found.kind), ("alikeness now", now), ("alikeness then", then)]
    parts = [
        tag("p", tag("strong", sentence(found.name.replace("_", " ")))),
        tag("p", sentence(found.reason)),
        tag("dl", *(joined([tag("dt", key), tag("dd", text)]) for key, text in rows)),
    ]
    if found.scenario is not None:
        parts.append(tag("p", "Its scenario is written beside this report, ready to run."))
    return tag("div", tag("h3", "What would decide"), *parts, class_="card")


def _parameters(diagnosis: Diagnosis) -> Html:
    shown = list(_worth_printing(diagnosis))
    if not shown:
        return Html("")
    rows = [
        [
            joined([tag("code", cause.effect), tag("small", sentence(meaning(cause.effect)))]), _listed(cause),
            percent(cause.probability),
        ]
        for cause in shown
    ]  # fmt: skip
    strong = [row for row, cause in enumerate(shown) if cause.effect in diagnosis.selected]
    heading = tag("h3", "Parameters of the likely effects, ± one standard deviation")
    return joined([heading, table(["effect", "parameters", "probability"], rows, 2, strong)])


def _worth_printing(diagnosis: Diagnosis) -> Iterator[Cause]:
    """Yield the causes that are selected, in a group that cannot be told apart, or not improbable."""
    named = {*diagnosis.selected, *(name for group in diagnosis.indistinguishable for name in group)}
    for rank, cause in enumerate(diagnosis.causes):
        if cause.parameters and (cause.effect in named or (cause.probability >= LIKELY and rank < MOST)):
            yield cause


def _listed(cause: Cause) -> Html:
    return bullets(f"{name.replace('_', ' ')} {estimate(value)}" for name, value in cause.parameters.items())
