"""What the pictures show: the right lines, in the right units, under the right names."""

from dataclasses import replace

import numpy as np
import pytest

from seatsim.effects.base import EFFECTS
from seatsim.plots.bench.vibration import plot_damping
from seatsim.plots.runs import looks, signals
from seatsim.plots.runs.comparison import plot_comparison
from seatsim.plots.runs.dampers import plot_force_velocity
from seatsim.plots.runs.signals import CLOSE_UP
from seatsim.plots.thinning import BINS, thin_line
from seatsim.scenario.loading import load
from seatsim.simulation.result import History

from ..report import kinds


def texts(figure):
    return [text.get_text() for text in figure.texts]


def of_runs(plot):
    return lambda runs: plot(*looks.show_runs(runs))


plot_time_histories, plot_psd = of_runs(signals.plot_time_histories), of_runs(signals.plot_psd)
plot_transmissibility = of_runs(signals.plot_transmissibility)


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def with_channels(run, **channels):
    return replace(run, history=History(run.history.step, {**run.history.channels, **channels}))


def with_scenario(run, **changes):
    return replace(run, scenario=replace(run.scenario, **changes))


def test_thinning_keeps_extremes_and_order():
    x, y = np.arange(100_003.0), np.random.default_rng(0).standard_normal(100_003)
    y[[0, 54_321, 100_002]] = 40, 50, -60
    thin_x, thin_y = thin_line(x, y)
    assert len(thin_x) <= 2 * BINS and np.all(np.diff(thin_x) >= 0)
    assert thin_y.max() == 50 and thin_y.min() == -60 and thin_y[0] == 40
    np.testing.assert_array_equal(thin_y, y[thin_x.astype(int)])


def test_the_close_up_is_stated_and_shared(made_up):
    figure = plot_time_histories([made_up({"variant": "a"}), made_up({"variant": "b"}, seconds=7.0)])
    start, end = figure.axes[0].get_xlim()
    assert end - start == pytest.approx(CLOSE_UP) and end <= 7.0
    assert texts(figure)[1].startswith(f"{start:.1f} to {end:.1f} s, where the driver's RMS")
    assert {axes.get_xlim() for axes in figure.axes} == {(start, end)}


def test_displacement_is_in_millimetres_within_the_limits_of_plant_and_buffers(made_up):
    buffers = EFFECTS.find("suspension.end_stop")(low=-0.03, high=0.045)
    for effects, limits in (((), [-50.0, 50.0]), ((buffers,), [-30.0, 45.0])):
        axes = plot_time_histories([with_scenario(made_up(), effects=effects)]).axes[1]
        assert np.max(axes.lines[0].get_ydata()) == pytest.approx(20.0, rel=1e-3)
        assert [line.get_ydata()[0] for line in axes.lines[1:3]] == limits


def test_a_force_is_wanted_only_where_a_law_wants_one(made_up):
    with_force, without = (plot_time_histories([made_up(wanted=wanted)]).axes[2] for wanted in (True, False))
    assert [line.get_label() for line in with_force.lines] == ["wanted force, commanded current", "the run"]
    assert len(without.lines) == 1


def test_of_many_runs_the_close_up_has_those_at_the_ends_and_counts_those_left_out(made_up):
    runs = [made_up({"variant": f"law {k}"}, motion=1.0 + (k - 2.1) ** 2) for k in range(5)]
    runs[1] = with_scenario(runs[1], control=load("em5")[1].control)
    figure = plot_time_histories(runs)
    assert legend(figure)[:3] == ["law 0", "law 1", "law 2"]
    said = " ".join(texts(figure)[1].split())
    assert "of 5 runs: “law 0” (least comfortable), “law 1” (best passive) and “law 2” (most comfortable)." in said
    widths = [line.get_linewidth() for line in figure.axes[0].lines[:3]]
    assert widths == sorted(widths, reverse=True)
    for doubtful, names in (([2], "“law 3” (most comfortable)"), (range(5), "“law 1 *” and “law 2 *”. * not verified")):
        shown = [replace(run, unverified=("a reason",) * (k in doubtful)) for k, run in enumerate(runs)]
        assert names in " ".join(texts(plot_time_histories(shown))[1].split())


def test_the_density_of_white_noise_is_flat(made_up):
    run = made_up(seconds=60.0)
    floor, _ = plot_psd([run]).axes[0].lines
    level, high = 2 * run.history.step * np.var(run.history["floor_acceleration"]), floor.get_xdata() > 5
    np.testing.assert_allclose(floor.get_ydata()[high], level, rtol=0.6)
    assert np.mean(floor.get_ydata()[high]) == pytest.approx(level, rel=0.05)


@pytest.mark.parametrize(
    ("picture", "change", "reason"),
    [(plot_psd, {"motion": 0.0}, "at rest"), (plot_transmissibility, {"motion": 0.0}, "no floor motion"),
     (plot_transmissibility, {"seconds": 0.5}, "needs 4.5 s"), (plot_transmissibility, {}, "explains less than 0.5")],
)  # fmt: skip
def test_an_empty_spectrum_says_which_cause_empties_it(picture, change, reason, made_up):
    run = made_up(**change)
    run = with_channels(run, driver_acceleration=np.zeros(len(run.history["time"])))
    axes = picture([run]).axes[0]
    assert reason in axes.texts[0].get_text().replace("\n", " ") and len(axes.get_yticks()) == 0


def test_force_velocity_shows_the_run_within_the_dampers_curves(made_up):
    run = made_up(warming=15.0)
    axes, bar = (figure := plot_force_velocity([run])).axes
    dots = axes.collections[0].get_offsets()
    every = -(-len(run.history["time"]) // len(dots))
    np.testing.assert_allclose(np.sort(dots[:, 1]), np.sort(run.history["damper_force"][::every]))
    assert axes.lines[1].get_xdata().max() == pytest.approx(np.abs(run.history["suspension_velocity"]).max())
    tests = ["sine test at 0 A, 20 °C", "sine test at 1 A, 20 °C"]
    assert legend(figure) == ["run at 20 to 35 °C (colour: current)", *tests, "the damper gives energy back"]
    ends = (0.0, np.quantile(run.history["coil_current"], 0.99))
    assert axes.collections[0].get_clim() == ends and bar.get_ylim() == ends


def test_a_sweep_is_compared_over_its_number(made_up):
    runs = [made_up({"variant": v, "temperature": t}) for v in "ab" for t in (80, 20, 50)]
    figure = plot_comparison(runs)
    assert legend(figure) == ["a", "b"]
    assert [axes.get_xlabel() for axes in figure.axes] == ["damper temperature [°C]"] * 4
    assert [*figure.axes[0].lines[0].get_xdata()] == [*figure.axes[0].get_xticks()] == [20.0, 50.0, 80.0]
    travel = 1e3 * runs[0].metrics["suspension_displacement_rms"].value
    assert figure.axes[2].lines[0].get_ydata()[2] == pytest.approx(travel)


def test_a_damping_test_says_whether_a_seat_keeps_to_its_limits():
    found = kinds.seat_test()
    for passed, said in ((True, "The largest value of each line keeps to its limits."), (False, "of “seat” exceeds")):
        rows = [row._replace(passed=passed) for row in found.damping_rows]
        assert said in " ".join(texts(plot_damping(found._replace(damping_rows=rows))["damping"])[1].split())
