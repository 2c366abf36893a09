"""Pictures of a diagnosis that a notebook shows: legible, inside their frame, with units and legends."""

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from seatsim.plots.diagnosis import answer, signals
from seatsim.plots.diagnosis.answer import select_stages
from seatsim.plots.diagnosis.bins import drop_start, find_window, find_worst

from ..report.diagnoses import RATE, known, none, unknown


@pytest.fixture(scope="module")
def pictures():
    diagnosis = replace(unknown(("damper_force",)), selected=["damper.magnetic_saturation"])
    found = [
        answer.plot_gaps(diagnosis),
        answer.plot_location(diagnosis),
        answer.plot_ranking(diagnosis),
    ]
    found += [*signals.plot_signals(diagnosis), *signals.plot_spectra(diagnosis)]
    for picture in found:
        FigureCanvasAgg(picture.figure).draw()
    return found


def test_texts_are_legible_and_inside_the_picture(pictures):
    for picture in pictures:
        width, height = picture.figure.canvas.get_width_height()
        assert min(text.get_fontsize() for text in picture.figure.findobj(Text)) >= 9
        for part in [*picture.figure.axes, *picture.figure.legends]:
            box = part.get_tightbbox()
            assert box.x0 >= 0 and box.x1 <= width and box.y0 >= 0 and box.y1 <= height, (picture.title, part, box)


def test_every_scale_has_a_unit_and_lines_have_a_legend(pictures):
    for picture in pictures:
        panels = picture.figure.axes
        assert any(axes.get_xlabel().endswith("]") for axes in panels)
        for axes in panels:
            numbered = any(
                re.search(r"\d", label.get_text()) for label in axes.get_yticklabels() if label.get_visible()
            )
            assert not numbered or axes.get_ylabel().endswith("]"), picture.title
        if len(panels[0].lines) > 2:
            assert picture.figure.legends, picture.title


def test_a_window_holds_the_burst():
    rows = np.arange(10_000) / RATE
    values = np.where((rows > 12.4) & (rows < 13.9), 1.0, 0.01)
    window = find_window(rows, values, 2.0)
    assert window.start <= 12.4 and window.end >= 13.9 and window.end - window.start == pytest.approx(2.0)
    assert tuple(find_window(rows[:50], values[:50], 2.0)) == (0.0, pytest.approx(0.098))


def test_the_first_second_is_left_out_and_the_worst_channel_is_mapped():
    diagnosis = known()
    trace, motion = find_worst(diagnosis)
    assert trace.channel == "frame_acceleration" and trace.time[0] == 1.0
    assert len(motion["velocity"]) == len(trace.time) == len(drop_start(diagnosis.evidence.traces[0]).time)
    assert len(drop_start(trace).time) == len(trace.time)


def test_stages_without_effects_do_not_repeat_the_refit():
    assert [stage.key for stage in select_stages(known())] == ["floor", "before", "calibrated", "after"]
    assert [stage.key for stage in select_stages(none())] == ["floor", "before", "calibrated"]
