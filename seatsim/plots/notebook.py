"""The pictures of a value by name, as Python gives them and a notebook shows them."""

from __future__ import annotations

import base64
import html
import io

from matplotlib.figure import Figure

from seatsim.diagnosis.result import Diagnosis
from seatsim.identification.identify import Identification
from seatsim.plots.bench.identification import plot_predictions
from seatsim.plots.diagnosis import plot_all_of_gap, plot_diagnosis
from seatsim.plots.runs.draw import plot_result
from seatsim.recordings.gap import Gap
from seatsim.schema.errors import InputError, nearest
from seatsim.simulation.result import Result

DPI = 100
"""Dots per inch of a picture in a notebook: fewer make the letters wider than their lines have room for."""


class Pictures(dict[str, Figure]):
    """Figures by name; a notebook shows them below each other."""

    def _repr_html_(self) -> str:
        return "".join(f'<img alt="{html.escape(name)}" src="{_embed(figure)}">' for name, figure in self.items())


def plot(value: object, *names: str) -> Pictures:
    """Return the pictures of a result, gap, diagnosis or identification by name: those that are named, or all.

    Raises:
        InputError: it has no picture of that name.
    """
    figures = _list_figures(value)
    for name in names:
        if name not in figures:
            raise InputError(f"no picture is called '{name}'{nearest(name, figures)}; permitted: {', '.join(figures)}")
    return Pictures({name: figures[name] for name in names or figures})


def _embed(figure: Figure) -> str:
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=DPI)
    return "data:image/png;base64," + base64.b64encode(image.getvalue()).decode("ascii")


def _list_figures(value: object) -> dict[str, Figure]:
    match value:
        case Result():
            return plot_result(value)
        case Gap():
            return plot_all_of_gap(value)
        case Identification():
            return {"loops": plot_predictions(value)}
        case Diagnosis():
            return plot_diagnosis(value)
    raise InputError(f"nothing is drawn of a {type(value).__name__}; give a result, gap, diagnosis or identification")
