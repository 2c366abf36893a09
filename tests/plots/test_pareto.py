"""Comfort against travel: its panels, its names, its bracket."""

import dataclasses

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Annotation

from seatsim.metrics.table import Metric
from seatsim.plots.runs.pareto import BEST, BOUND, plot_pareto
from seatsim.plots.runs.placing import place_names
from seatsim.simulation.result import Run


class Fake:
    travel, acceleration = np.array([0.006, 0.014]), np.array([0.9, 0.5])

    def bound(self, travel):
        return 0.4 + 0.0 * np.asarray(travel)

    def best(self, travel):
        return np.interp(travel, self.travel, self.acceleration, left=np.nan)


@pytest.fixture
def runs(made_up):
    def build(names, temperatures=(20.0,)):
        base, rng, found = made_up(seconds=1.0), np.random.default_rng(2), []
        for temperature in temperatures:
            for name in names:
                label = {"variant": name} | ({"temperature": temperature} if len(temperatures) > 1 else {})
                scenario = dataclasses.replace(base.scenario, temperature=temperature, label=label)
                metrics = base.metrics | {
                    "driver_acceleration_weighted": Metric(float(rng.uniform(0.6, 1.6)), "m/s^2", ""),
                    "suspension_displacement_rms": Metric(float(rng.uniform(0.005, 0.015)), "m", ""),
                }
                found.append(Run(scenario, base.history, metrics))
        return found

    return build


def names_of(figure):
    FigureCanvasAgg(figure).draw()
    return [[text for text in axes.texts if isinstance(text, Annotation) and text.get_text()] for axes in figure.axes]


@pytest.mark.parametrize(
    ("count", "temperatures"), [(4, (20.0,)), (18, (20.0,)), (4, (20.0, 80.0)), (18, (20.0, 50.0, 80.0))]
)
def test_no_two_names_overlap(runs, count, temperatures):
    figure = plot_pareto(runs([f"law of length {n}" for n in range(count)], temperatures), {})
    panels = names_of(figure)
    assert [len(panel) for panel in panels] == [count] * len(temperatures)
    for panel in panels:
        boxes = [text.get_window_extent().padded(-1.5) for text in panel]
        assert not any(box.overlaps(other) for k, box in enumerate(boxes) for other in boxes[:k])


def test_panels_are_titled_and_points_named_by_what_sets_them_apart(runs):
    figure = plot_pareto(runs(["soft", "hard"], (20.0, 80.0)), {})
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["20 °C", "80 °C"]
    assert [text.get_text() for text in names_of(figure)[0]] == ["soft", "hard"]


def test_rigs_of_one_run_share_a_panel(runs):
    assert len(plot_pareto(runs(["soft"], (20.0, 50.0, 80.0)), {}).axes) == 1


def test_bracket_is_drawn_where_there_is_one(runs):
    both = runs(["soft", "hard"], (20.0, 80.0))
    figure = plot_pareto(both, {both[0].scenario.rig: Fake()})
    with_bracket, without = figure.axes
    assert [line.get_label() for line in with_bracket.lines] == [BOUND.label, BEST.label]
    assert not without.lines
    assert with_bracket.get_ylim()[0] < 0.4
    assert [text.get_text() for text in figure.legends[0].get_texts()][:2] == [BOUND.label, BEST.label]


def test_a_rig_of_one_run_has_a_panel_where_there_are_brackets(runs):
    both = runs(["soft"], (20.0, 80.0))
    assert len(plot_pareto(both, {both[0].scenario.rig: Fake()}).axes) == 2


def test_without_weighted_accelerations_it_says_so(runs):
    bare = [dataclasses.replace(run, metrics={}) for run in runs(["soft", "hard"])]
    [axes] = plot_pareto(bare, {}).axes
    assert "200 samples" in axes.texts[0].get_text()


def test_a_name_without_room_is_told():
    assert place_names([(0.5, 0.5)], ["a name longer than its panel"], (1.0, 1.0)) is None
