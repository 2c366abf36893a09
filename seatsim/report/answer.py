"""The head of the report: the answer, the verdict, the gaps."""

from __future__ import annotations

import math

from seatsim.diagnosis.result import Diagnosis, GapFigures
from seatsim.plots.diagnosis import answer as diagnosis_answer
from seatsim.report.html import Html, joined, pictures, table, tag
from seatsim.report.words import listed, percent, sentence

VERDICTS = {
    "none": ("✓", "No material gap", "Nothing to explain gap beyond noise and the tolerance of the parameters."),
    "known": ("●", "Cause known", "Effects of the library explain the gap on runs that took no part in the fit."),
    "ambiguous": ("◐", "Ambiguous", "Two or more effects explain the gap equally well on this recording."),
    "unknown": ("?", "Cause unknown", "A material gap stays that no effect of the library explains."),
}
"""Mark, words and explanation of each verdict."""


def head(diagnosis: Diagnosis) -> Html:
    """Return verdict, sentence and what the gap shrinks by."""
    mark, words, explanation = VERDICTS.get(diagnosis.verdict, ("?", diagnosis.verdict, ""))
    badge = tag("span", tag("span", mark, aria_hidden="true"), f" {words}", class_=f"badge {diagnosis.verdict}")
    return tag(
        "header",
        tag("p", f"Diagnosis of {diagnosis.name}", class_="eyebrow"),
        tag("p", badge, tag("span", explanation, class_="explanation"), class_="verdict"),
        tag("h1", sentence(diagnosis.sentence)),
        tag("p", _shrink(diagnosis), class_="lead") if diagnosis.verdict != "none" else Html(""),
    )


def gaps(diagnosis: Diagnosis) -> Html:
    """Return the table of the gaps on held-out runs and its picture."""
    channels = list(diagnosis.gap.before.channels)
    stages = diagnosis_answer.stages(diagnosis)[1:]
    head = ["gap", *(words for _, words, *_ in stages), "noise floor", "shrinks by"]
    if diagnosis.verdict == "none":
        head = head[:-1]
    rows = [_row(diagnosis, name, [stage for stage, *_ in stages])[: len(head)] for name in ["overall", *channels]]
    return joined(
        [
            tag("p", _explained(diagnosis), class_="lead"),
            tag("div", table(head, rows, strong=[0]), pictures([diagnosis_answer.gaps(diagnosis)]), class_="beside"),
        ]
    )


def _row(diagnosis: Diagnosis, name: str, stages: list[str]) -> list[str]:
    gap = diagnosis.gap
    found = [_value(getattr(gap, stage), name) for stage in (*stages, "floor")]
    before, after = _value(gap.before, name), _value(gap.after, name)
    change = 1 - after / before if after is not None and before else None
    if name == "overall" and math.isfinite(gap.shrink):
        change = gap.shrink
    return [name.replace("_", " "), *(percent(value) for value in found), percent(change)]


def _shrink(diagnosis: Diagnosis) -> str:
    gap = diagnosis.gap
    if not diagnosis.selected:
        stages = (_value(values, "overall") for values in (gap.before, gap.calibrated, gap.floor))
        before, after, floor = (percent(value) for value in stages)
        return f"Refitting alone takes the gap from {before} to {after}; noise alone makes {floor}."
    if not math.isfinite(gap.shrink):
        return ""
    low, high = gap.shrink_interval
    between = f" (90 % interval {percent(low)} to {percent(high)})" if math.isfinite(low + high) else ""
    runs = f" on {listed(diagnosis.held_out)}, which took no part in the fit" if diagnosis.held_out else ""
    effects = "effect" if len(diagnosis.selected) == 1 else "effects"
    return f"The gap shrinks by {percent(gap.shrink)}{between} with the {effects} found{runs}."


def _explained(diagnosis: Diagnosis) -> str:
    text = (
        "Gap: RMS of measured less simulated, over the standard deviation of the measured signal."
        " Refitted: nominal parameters moved inside their tolerance."
    )
    if diagnosis.selected:
        text += " Only what the effects take off beyond that is credited to them."
    if diagnosis.verdict == "none":
        low, high = (_value(values, "overall") for values in (diagnosis.gap.floor, diagnosis.gap.before))
        known = low is not None and high is not None
        text += f" The nominal simulation is off by {percent(high)}; noise alone makes {percent(low)}." if known else ""
    return text


def _value(figures: GapFigures, name: str) -> float | None:
    """Return the overall figure, or that of a channel; None where the channel is not compared."""
    return figures.overall if name == "overall" else figures.channels.get(name)
