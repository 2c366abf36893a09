"""The head of the report: the answer, the verdict, the gaps."""

from __future__ import annotations

import math
from collections.abc import Sequence

from seatsim.diagnosis.result import Diagnosis
from seatsim.plots.diagnosis.answer import Key, plot_gaps, read_gap, select_stages
from seatsim.report.formatting import format_percent, format_sentence
from seatsim.report.html import Html, embed_pictures, join, make_table, tag
from seatsim.schema.text import join_names

VERDICTS = {
    "none": ("✓", "No material gap", "Nothing to explain gap beyond noise and the tolerance of the parameters."),
    "known": ("●", "Cause known", "Effects of the library explain the gap on runs that took no part in the fit."),
    "ambiguous": ("◐", "Ambiguous", "Two or more effects explain the gap equally well on this recording."),
    "unknown": ("?", "Cause unknown", "A material gap stays that no effect of the library explains."),
}
"""Mark, words and explanation of each verdict; the mark differs too, so that colour is not the only sign."""


def render_head(diagnosis: Diagnosis) -> Html:
    """Return the head of the page: verdict, answer in a sentence, and what the gap shrinks by."""
    mark, words, explanation = VERDICTS.get(diagnosis.verdict, ("?", diagnosis.verdict, ""))
    badge = tag("span", tag("span", mark, aria_hidden="true"), f" {words}", class_=f"badge {diagnosis.verdict}")
    return tag(
        "header",
        tag("p", f"Diagnosis of {diagnosis.name}", class_="eyebrow"),
        tag("p", badge, tag("span", explanation, class_="explanation"), class_="verdict"),
        tag("h1", format_sentence(diagnosis.sentence)),
        tag("p", _describe_shrink(diagnosis), class_="lead") if diagnosis.verdict != "none" else Html(""),
    )


def render_gaps(diagnosis: Diagnosis) -> Html:
    """Return the table of the gaps on held-out runs and its picture."""
    channels = list(diagnosis.gap.before.channels)
    # The noise floor comes first in the figure, where it lies behind the others, and last in the table.
    stages = select_stages(diagnosis)[1:]
    head = ["gap", *(stage.words for stage in stages), "noise floor", "shrinks by"]
    if diagnosis.verdict == "none":
        head = head[:-1]
    keys = [stage.key for stage in stages]
    rows = [_make_row(diagnosis, name, keys)[: len(head)] for name in ["overall", *channels]]
    return join(
        [
            tag("p", _explain_gap(diagnosis), class_="lead"),
            tag("div", make_table(head, rows, strong=[0]), embed_pictures([plot_gaps(diagnosis)]), class_="beside"),
        ]
    )


def _make_row(diagnosis: Diagnosis, name: str, keys: Sequence[Key]) -> list[str]:
    gap = diagnosis.gap
    found = [read_gap(gap, key, name) for key in keys] + [read_gap(gap, "floor", name)]
    before, after = read_gap(gap, "before", name), read_gap(gap, "after", name)
    # The overall shrink is relative to the refitted rig, so that no effect is credited with the tolerance.
    change = 1 - after / before if after is not None and before else None
    if name == "overall" and math.isfinite(gap.shrink):
        change = gap.shrink
    return [name.replace("_", " "), *(format_percent(value) for value in found), format_percent(change)]


def _describe_shrink(diagnosis: Diagnosis) -> str:
    gap = diagnosis.gap
    if not diagnosis.selected:
        keys: tuple[Key, ...] = ("before", "calibrated", "floor")
        before, after, floor = (format_percent(read_gap(gap, key, "overall")) for key in keys)
        return f"Refitting alone takes the gap from {before} to {after}; noise alone makes {floor}."
    if not math.isfinite(gap.shrink):
        return ""
    low, high = gap.shrink_interval
    between = f" (90 % interval {format_percent(low)} to {format_percent(high)})" if math.isfinite(low + high) else ""
    runs = f" on {join_names(diagnosis.held_out)}, which took no part in the fit" if diagnosis.held_out else ""
    effects = "effect" if len(diagnosis.selected) == 1 else "effects"
    return f"The gap shrinks by {format_percent(gap.shrink)}{between} with the {effects} found{runs}."


def _explain_gap(diagnosis: Diagnosis) -> str:
    text = (
        "Gap: RMS of measured less simulated, over the standard deviation of the measured signal."
        " Refitted: nominal parameters moved inside their tolerance."
    )
    if diagnosis.selected:
        text += " Only what the effects take off beyond that is credited to them."
    if diagnosis.verdict == "none":
        low, high = read_gap(diagnosis.gap, "floor", "overall"), read_gap(diagnosis.gap, "before", "overall")
        if low is not None and high is not None:
            text += (
                f" The nominal simulation is off by {format_percent(high)}; noise alone makes {format_percent(low)}."
            )
    return text
