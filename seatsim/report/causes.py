"""Causes of the gap: probabilities, parameters, equivalent effects, and the experiment that would decide."""

from __future__ import annotations

from collections.abc import Iterator

from seatsim.diagnosis.result import Cause, Diagnosis
from seatsim.plots.diagnosis.answer import MOST, plot_location, plot_ranking
from seatsim.plots.diagnosis.collinearity import plot_collinearity
from seatsim.report.formatting import (
    describe_effect,
    format_estimate,
    format_percent,
    format_sentence,
    format_value,
)
from seatsim.report.html import Html, embed_pictures, join, make_list, make_table, tag
from seatsim.schema.text import join_names

LIKELY = 0.05
"""Probability from which on the parameters of a cause are printed."""


def render_causes(diagnosis: Diagnosis) -> Html:
    """Return where the gap lies, which effects may cause it, and their parameters."""
    left = join([embed_pictures([plot_location(diagnosis)]), _render_parameters(diagnosis)])
    return tag("div", tag("div", left), embed_pictures([plot_ranking(diagnosis)]), class_="beside")


def render_confusions(diagnosis: Diagnosis) -> Html:
    """Return which effects this recording cannot tell apart, in sentences and as a heat map of collinearity."""
    sentences = [
        f"This recording cannot distinguish {join_names(group)}: each explains the gap equally well."
        for group in diagnosis.indistinguishable
        if len(group) > 1
    ]
    decides, collinear = _render_experiment(diagnosis), embed_pictures([plot_collinearity(diagnosis)])
    lead = [tag("p", text, class_="lead") for text in sentences]
    return join([*lead, tag("div", collinear, decides, class_="beside")]) if lead or decides or collinear else Html("")


def render_forms(diagnosis: Diagnosis) -> Html:
    """Return the table of other forms of the damper, where they were tried."""
    forms = diagnosis.alternatives
    if not forms:
        return Html("")
    own = forms[0].replaces
    lead = (
        f"Other models of the damper in the place of {own}, fitted to the damper force without the held-out run, free"
        f" of the tolerance. Shares are of the refitted gap on that run; last is {own} itself, fitted as freely."
    )
    rows = [
        [tag("code", form.model), join_names(form.beside or ["no effect"]), format_percent(form.shrink),
         format_percent(form.refitted)]
        for form in forms
    ]  # fmt: skip
    head = ["model", "together with", "shrinks the gap by", f"{own}, fitted as freely"]
    return join([tag("p", lead, class_="lead"), make_table(head, rows, 2, [0])])


def _render_experiment(diagnosis: Diagnosis) -> Html:
    """Return the experiment that would decide, as it is described."""
    found = diagnosis.experiment
    if found is None:
        return Html("")
    now, then = format_value(found.likeness_now), format_value(found.likeness_then)
    rows = [("kind", found.kind), ("likeness now", now), ("likeness then", then)]
    parts = [
        tag("p", tag("strong", format_sentence(found.name.replace("_", " ")))),
        tag("p", format_sentence(found.reason)),
        tag("dl", *(join([tag("dt", key), tag("dd", text)]) for key, text in rows)),
    ]
    if found.scenario is not None:
        parts.append(tag("p", "Its scenario is written beside this report, ready to run."))
    return tag("div", tag("h3", "What would decide"), *parts, class_="card")


def _render_parameters(diagnosis: Diagnosis) -> Html:
    shown = list(_select_causes(diagnosis))
    if not shown:
        return Html("")
    rows = [
        [
            join([tag("code", cause.effect), tag("small", format_sentence(describe_effect(cause.effect)))]),
            _list_parameters(cause), format_percent(cause.probability),
        ]
        for cause in shown
    ]  # fmt: skip
    strong = [row for row, cause in enumerate(shown) if cause.effect in diagnosis.selected]
    heading = tag("h3", "Parameters of the likely effects, ± one standard deviation")
    return join([heading, make_table(["effect", "parameters", "probability"], rows, 2, strong)])


def _select_causes(diagnosis: Diagnosis) -> Iterator[Cause]:
    """Yield the causes that are selected, in a group that cannot be told apart, or not improbable."""
    named = {*diagnosis.selected, *(name for group in diagnosis.indistinguishable for name in group)}
    for rank, cause in enumerate(diagnosis.causes):
        if cause.parameters and (cause.effect in named or (cause.probability >= LIKELY and rank < MOST)):
            yield cause


def _list_parameters(cause: Cause) -> Html:
    return make_list(f"{name.replace('_', ' ')} {format_estimate(value)}" for name, value in cause.parameters.items())
