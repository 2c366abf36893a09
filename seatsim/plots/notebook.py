"""The pictures that a notebook shows of a value, by name."""

from __future__ import annotations

from functools import singledispatch

from matplotlib.figure import Figure

from seatsim.diagnosis.result import Diagnosis
from seatsim.identification.identify import Identification
from seatsim.plots.bench.identification import plot_predictions
from seatsim.plots.diagnosis.answer import plot_gap, plot_gaps, plot_location, plot_ranking
from seatsim.plots.diagnosis.signals import plot_signals
from seatsim.plots.runs.draw import plot_result
from seatsim.recordings.gap import Gap
from seatsim.simulation.result import Result


@singledispatch
def list_figures(value: object) -> dict[str, Figure]:
    """Return the figures of a result, gap, diagnosis or identification by name."""
    raise TypeError(f"nothing is drawn of a {type(value).__name__}")


@list_figures.register
def _(value: Result) -> dict[str, Figure]:
    return plot_result(value)


@list_figures.register
def _(value: Gap) -> dict[str, Figure]:
    return {"gap": plot_gap(value)}


@list_figures.register
def _(value: Identification) -> dict[str, Figure]:
    return {"loops": plot_predictions(value)}


@list_figures.register
def _(value: Diagnosis) -> dict[str, Figure]:
    signals = {f"signals_{k}": picture for k, picture in enumerate(plot_signals(value), start=1)}
    found = {"gaps": plot_gaps(value), "location": plot_location(value), "ranking": plot_ranking(value), **signals}
    return {name: picture.figure for name, picture in found.items() if picture is not None}
