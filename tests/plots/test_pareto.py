"""Comfort against travel: its panels, its names, its floor."""

import dataclasses
from itertools import combinations, product

import numpy as np
import pytest

from seatsim.metrics.table import Metric
from seatsim.plots.runs.comparison import plot_pareto
from seatsim.simulation.result import Run


@pytest.fixture
def runs(made_up):
    def build(names, temperatures=(20.0,)):
        base, rng, found = made_up(seconds=1.0), np.random.default_rng(2), []
        for temperature, name in product(temperatures, names):
            label = {"variant": name} | ({"temperature": temperature} if len(temperatures) > 1 else {})
            scenario = dataclasses.replace(base.scenario, temperature=temperature, label=label)
            felt, travel = Metric(rng.uniform(0.6, 1.6), "m/s^2", ""), Metric(rng.uniform(0.005, 0.015), "m", "")
            metrics = {"driver_acceleration_weighted": felt, "suspension_displacement_rms": travel}
            found.append(Run(scenario, base.history, base.metrics | metrics))
        return found

    return build


def test_panels_are_titled_and_points_named_by_what_sets_them_apart(runs):
    drawn = runs(["soft", "hard"], (20.0, 80.0))
    figure = plot_pareto([dataclasses.replace(drawn[0], unverified=("a reason",)), *drawn[1:]])
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["20 °C", "80 °C"]
    assert [[text.get_text() for text in axes.texts] for axes in figure.axes] == [["soft *", "hard"], ["soft", "hard"]]
    assert "* not verified" in figure.texts[1].get_text()
    # Of many points no two lines to their names cross, and no axis of an RMS begins below zero.
    [axes] = plot_pareto(runs([f"law {k}" for k in range(25)])).axes
    paths = axes.collections[-1].get_paths()
    assert not any(one.intersects_path(other, filled=False) for one, other in combinations(paths, 2))
    assert min(*axes.get_xlim(), *axes.get_ylim()) >= 0
