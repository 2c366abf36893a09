"""The figures by which a simulation is signed off: objective ratings, and the error beside its uncertainty."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.metrics.objective_rating import GRADES, ObjectiveRating
from seatsim.plots.labels import describe_channel, format_number
from seatsim.recordings.gap import Gap
from seatsim.recordings.validation import Validation
from seatsim.report.blocks import Block, Items, Table, Text

_RATINGS = (
    "Corridor: how much of the time the simulation stays near the measured signal, within 5 % of its largest"
    " magnitude for a full mark and 50 % for none. Blind where a single peak makes all the rest small.",
    "Phase: the time shift at which both curves correlate best, against a fifth of the run. Blind in a long run,"
    " where a lag that ruins a controller costs nothing: read the shift itself. It is 1 where nothing correlates.",
    "Magnitude: the difference of size after the shift and a warping in time of up to a tenth of the run. Blind to"
    " errors of timing, and to noise that the warping follows.",
    "Slope: the difference of the slopes after the shift. It sees noise and high frequencies most, and no offset.",
    f"Overall: 0.4 corridor + 0.2 of each other; {', '.join(f'{k} above {v:g}' for k, v in GRADES.items() if v > 0)},"
    " else poor. The grades were set for crash signals of a tenth of a second; they say nothing about causes.",
)
_ERRORS = (
    "The error E is the RMS of simulation less data. u_num: what halving the step of the integration changes. u_input:"
    " what the noise of the recorded inputs and the tolerances of the parameters change. u_D: the stated noise of the"
    " sensor. An error above u_val, the root of their squares, is one of the model, of between E - u_val and E + u_val."
    " u_val knows what was stated only: a wrong scale of a sensor, or a tolerance that is too narrow, passes for an"
    " error of the model, and a generous tolerance hides one."
)


def show_agreement(found: Gap) -> list[Block]:
    """Return the ratings and the errors of the channels with what each figure means, nothing where there are none."""
    if not found.iso18571:
        return []
    return [_show_ratings(found.iso18571), Items(_RATINGS), _show_errors(found.v_and_v), Text(_ERRORS)]


def _show_ratings(ratings: Mapping[str, ObjectiveRating]) -> Table:
    rows = []
    for name, rating in ratings.items():
        shares = (f"{each:.3f}" for each in (rating.overall, *rating[:4]))
        rows.append([name.replace("_", " "), rating.grade, *shares, format_number(1e3 * rating.shift)])
    caption = "Objective rating after ISO/TS 18571 against the measured signal, mean over the runs; 1 is identical"
    return Table(caption, ["channel", "grade", "overall", *ObjectiveRating._fields[:4], "late by [ms]"], rows, 2)


def _show_errors(errors: Mapping[str, Validation]) -> Table:
    rows = []
    for name, each in errors.items():
        shown = describe_channel(name, each.unit)
        figures = (each.error, each.u_val, each.u_num, each.u_input, each.u_d)
        rows.append([shown.words, shown.unit, *(format_number(shown.factor * figure) for figure in figures)])
    head = ["channel", "unit", "error E", "u_val", "step u_num", "inputs u_input", "sensor u_D"]
    return Table("Comparison error and validation uncertainty after ASME V&V 20, over all runs", head, rows, 2)
