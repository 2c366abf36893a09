"""Every picture of every kind of result: legible, inside its page, free of collisions, fit for a page of HTML."""

import re
from itertools import combinations
from urllib.parse import unquote
from xml.etree import ElementTree

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from seatsim.characterisation.summary import characterise
from seatsim.plots.bench.characterisation import plot_characterisation
from seatsim.plots.bench.identification import plot_predictions
from seatsim.plots.bench.vibration import plot_damping, plot_vibration
from seatsim.plots.diagnosis import plot_all_of_gap, plot_diagnosis
from seatsim.plots.runs.draw import plot_result
from seatsim.plots.saving import render_inline
from seatsim.plots.style import WIDTH
from seatsim.recordings.gap import Gap, GapFigures, ReplayedPair
from seatsim.report.sweep import draw_figures
from seatsim.simulation.result import Result
from seatsim.sweeps.sensitivity import analyse_sensitivity

from ..report import diagnoses, kinds

EDGE = 4
"""Pixels of a hundred to the inch that stay free around a page."""
LONG = "a variant whose name goes on and on, beyond all use"
RUNS = {
    "warming": lambda make: [make(wanted=False, warming=15.0)],
    "at rest": lambda make: [make(motion=0.0, wanted=False)],
    "short": lambda make: [make(seconds=0.5)],
    "variants": lambda make: [make({"variant": v}, warming=5.0) for v in ("skyhook", "_passive $a$ b$")],
    "files": lambda make: [make(name="a road"), make(name="b road", seconds=7.0)],
    "scenarios": lambda make: [make({"variant": v}, name=n) for n in ("em1", "em5") for v in ("skyhook", "off")],
    "sweep": lambda make: [make({"variant": v, "temperature": t}) for v in ("skyhook", LONG) for t in (20, 50, 80)],
    "many": lambda make: [make({"variant": f"controller number {n}"}) for n in range(12)],
}


def draw_gap():
    traces, found = diagnoses.known().evidence.traces, diagnoses.known().gap.before
    signals = ({t.channel: getattr(t, name) for t in traces} for name in ("measured", "nominal", "unit"))
    runs, floor = {"run-c": ReplayedPair(traces[0].time, *signals)}, dict.fromkeys(found.channels, 0.0)
    return plot_all_of_gap(Gap(found.overall, found.channels, GapFigures(0.0, floor), replayed=runs))


def draw_seat_test():
    found = kinds.seat_test()
    return plot_damping(found._replace(damping=dict.fromkeys(("em1", "em5"), found.damping["seat"])))


OTHERS = {
    **{f"diagnosis, {name}": lambda make=make: plot_diagnosis(make()) for name, make in diagnoses.CASES.items()},
    "gap": draw_gap, "bench": lambda: plot_characterisation(characterise("scenarios/data/bench")),
    "identification": lambda: {"loops": plot_predictions(kinds.identification(["test", "test"], 2e5))},
    "seat test": draw_seat_test, "study": lambda: draw_figures(analyse_sensitivity(kinds.sweep()), kinds.sweep()),
    "comfort": lambda: plot_vibration(kinds.working_day()),
    "sensor": lambda: plot_diagnosis(diagnoses.unknown(lacking=("sensor", "error of frame_acceleration", "m/s^2"))),
}  # fmt: skip


@pytest.fixture(scope="module", params=[*RUNS, *OTHERS])
def figures(request, made_up):
    kind = request.param
    drawn = plot_result(Result(RUNS[kind](made_up))) if kind in RUNS else OTHERS[kind]()
    for figure in drawn.values():
        FigureCanvasAgg(figure).draw()
    return drawn


def test_everything_is_legible_and_inside_the_page(figures):
    for name, figure in figures.items():
        width, height = figure.canvas.get_width_height()
        assert figure.get_figwidth() == WIDTH and min(text.get_fontsize() for text in figure.findobj(Text)) >= 9
        for part in [*figure.axes, *figure.texts, *figure.legends]:
            box = part.get_tightbbox()
            inside = box.x0 >= EDGE and box.x1 <= width - EDGE and box.y0 >= EDGE and box.y1 <= height - EDGE
            assert inside, (name, part, box)


def test_no_two_texts_collide(figures):
    """Labels of ticks, of axes and titles, of all panels together, and labels of ticks moved to the ends of an axis."""
    for name, figure in figures.items():
        texts, moved = list(figure.texts), []
        for axes in figure.axes:
            texts += [axes.xaxis.label, axes.yaxis.label, axes._left_title]
            for axis in (axes.xaxis, axes.yaxis):
                low, high = sorted(axis.get_view_interval())
                ticks = axis.get_major_ticks()
                labels = [tick.label1 for tick in ticks if low <= tick.get_loc() <= high and tick.label1.get_visible()]
                texts += labels
                if axis is axes.xaxis and labels:
                    first, last = (labels[k].get_window_extent() for k in (0, -1))
                    left, right = axes.bbox.x0 - first.width / 2, axes.bbox.x1 + last.width / 2
                    moved.append(first.from_extents(left, first.y0, right, first.y1))
        boxes = [(text, text.get_window_extent()) for text in texts if text.get_text().strip() and text.get_visible()]
        for (text, box), (other, second) in combinations(boxes, 2):
            assert not box.padded(-1).overlaps(second.padded(-1)), (name, text, other)
        assert not any(one.overlaps(two) for one, two in combinations(moved, 2)), name


def test_every_axis_that_is_numbered_has_a_unit_and_lines_have_a_legend(figures):
    for name, figure in figures.items():
        for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
            texts = [tick.label1.get_text() for tick in axis.get_major_ticks() if tick.label1.get_visible()]
            numbered = any(re.match(r"[−\d.]+$", text) for text in texts)
            assert not numbered or axis.get_label_text().endswith("]"), (name, texts)
        if any(len(axes.lines) > 2 for axes in figure.axes) and "run" not in name:
            assert figure.legends or any(axes.get_legend() for axes in figure.axes), name
        for legend in figure.legends:
            samples = dict(zip((text.get_text() for text in legend.get_texts()), legend.legend_handles, strict=True))
            drawn = [(line, samples.get(line.get_label(), line)) for axes in figure.axes for line in axes.lines]
            assert all((a.get_color(), a.get_alpha()) == (b.get_color(), b.get_alpha()) for a, b in drawn), name


def test_a_picture_inside_a_page_is_a_drawing_of_its_own(figures):
    first = next(iter(figures.values()))
    assert render_inline(first) == render_inline(first)
    for name, figure in figures.items():
        shown = render_inline(figure)
        assert len(shown.source) < 200_000, (name, len(shown.source))
        assert shown.title and shown.title in figure.texts[0].get_text().replace("\n", " ").replace(r"\$", "$")
        drawing = ElementTree.fromstring(unquote(shown.source.removeprefix("data:image/svg+xml,")))
        texts = [each.text for each in drawing.iter("{http://www.w3.org/2000/svg}text")]
        assert texts and shown.title not in texts
        assert not any(value.startswith("http") for each in drawing.iter() for value in each.attrib.values())
        assert all(text.get_visible() for text in figure.texts)


def test_scenarios_have_pictures_of_their_own(made_up):
    figures = plot_result(Result(RUNS["scenarios"](made_up)))
    assert {"psd_em1", "psd_em5", "time_histories_em1", "transmissibility_em5"} <= set(figures) and "psd" not in figures
    first, second = ([text.get_text() for text in figures[f"psd_{n}"].legends[0].get_texts()] for n in ("em1", "em5"))
    assert first == second == ["skyhook", "off", "floor"]
