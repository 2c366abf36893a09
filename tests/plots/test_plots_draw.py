"""Every picture of every kind of result: complete, labelled, legible, inside its page, reproducible."""

import io

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from seatsim.plots.runs.draw import plot_result
from seatsim.simulation.result import Result

ALWAYS = {"time_histories", "psd", "transmissibility", "damper_loops", "force_velocity"}
LONG = "a variant whose name goes on and on, beyond all use"
CASES = {
    "single": lambda make: [make()],
    "no wanted force": lambda make: [make(wanted=False, warming=15.0)],
    "at rest": lambda make: [make(motion=0.0, wanted=False)],
    "short": lambda make: [make(seconds=0.5)],
    "variants": lambda make: [make({"variant": v}, warming=5.0) for v in ("skyhook", "_passive $a$ b$")],
    "files": lambda make: [make(name="a road"), make(name="b road", seconds=7.0)],
    "sweep": lambda make: [make({"variant": v, "temperature": t}) for v in ("skyhook", LONG) for t in (20, 50, 80)],
    "many": lambda make: [make({"variant": f"controller number {n}"}) for n in range(12)],
}


@pytest.fixture(scope="module", params=list(CASES))
def figures(request, made_up):
    drawn = plot_result(Result(CASES[request.param](made_up)))
    for figure in drawn.values():
        FigureCanvasAgg(figure).draw()
    return drawn


def test_the_figures_are_there(figures, request):
    several = request.node.callspec.params["figures"] in ("variants", "files", "sweep", "many")
    assert set(figures) == (ALWAYS | {"comparison", "pareto"} if several else ALWAYS)


def test_every_axis_that_is_numbered_has_a_unit(figures):
    for figure in figures.values():
        for axes in figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                texts = [text.get_text() for text in axis.get_ticklabels() if text.get_visible()]
                numbered = any(text[:1].isdigit() for text in texts)
                assert not numbered or axis.get_label_text().endswith("]"), texts


def test_lines_have_a_legend(figures):
    for figure in figures.values():
        if any(len(axes.lines) > 1 for axes in figure.axes):
            assert figure.legends or any(axes.get_legend() for axes in figure.axes)


def test_everything_is_inside_the_page(figures):
    for name, figure in figures.items():
        width, height = figure.canvas.get_width_height()
        for part in [*figure.axes, *figure.texts, *figure.legends]:
            box = part.get_tightbbox()
            assert box.x0 >= 0 and box.x1 <= width and box.y0 >= 0 and box.y1 <= height, (name, part, box)


def test_texts_are_legible_at_ten_inches(figures):
    for figure in figures.values():
        assert figure.get_figwidth() == 10.0
        assert min(text.get_fontsize() for text in figure.findobj(Text)) >= 9


def test_axis_labels_are_free(figures):
    for name, figure in figures.items():
        both = [text for axes in figure.axes for text in (axes.xaxis.label, axes.yaxis.label)]
        labels = [text for text in both if text.get_text()]
        boxes = [text.get_window_extent() for text in labels]
        for i, box in enumerate(boxes):
            others = boxes[:i] + [axes.get_window_extent() for axes in figure.axes]
            assert not any(box.overlaps(other) for other in others), (name, labels[i])


def test_equal_results_give_equal_bytes(made_up):
    first, second = (drawn_bytes(Result([made_up({"variant": name}) for name in "ab"])) for _ in range(2))
    assert first == second
    assert all(b"Date" not in png and b"Creation" not in png for png in first.values())


def drawn_bytes(result):
    files = {}
    for name, figure in plot_result(result).items():
        file = io.BytesIO()
        figure.savefig(file, dpi=50, metadata={"Software": "seatsim"})
        files[name] = file.getvalue()
    return files


def test_a_run_is_not_changed_by_drawing_it(made_up):
    run = made_up()
    before = {name: values.copy() for name, values in run.history.channels.items()}
    plot_result(Result([run]))
    for name, values in run.history.channels.items():
        np.testing.assert_array_equal(values, before[name])
