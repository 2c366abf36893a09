"""Pages, legends and text that all figures share."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.labels import clean_text
from seatsim.plots.style import LINE, WIDTH, Entry, Grid


def test_a_text_is_cut_in_the_middle_and_never_a_formula():
    assert clean_text("abcdefghij", 6) == "ab…hij"
    assert clean_text("_hidden", 20) == " _hidden"
    assert clean_text("$x$", 20) == r"\$x\$"


def test_panels_have_the_sizes_of_their_grid():
    grid = Grid((2.0, 1.0), columns=2, left=1.0, right=0.5, gap=(0.7, 0.4), bottom=0.6)
    page = style.make_page("title", "note", grid)
    height = page.figure.get_figheight()
    boxes = [[axes.get_position() for axes in row] for row in page.rows]
    assert [round(height * row[0].height, 9) for row in boxes] == [2.0, 1.0]
    assert WIDTH * boxes[0][0].x0 == pytest.approx(1.0) and WIDTH * (1 - boxes[0][1].x1) == pytest.approx(0.5)
    assert WIDTH * (boxes[0][1].x0 - boxes[0][0].x1) == pytest.approx(0.7)
    assert height * (boxes[0][0].y0 - boxes[1][0].y1) == pytest.approx(0.4)
    assert height * boxes[1][0].y0 == pytest.approx(0.6)


def test_a_legend_makes_the_page_higher_not_the_panels_smaller():
    grid = Grid((2.0,))
    bare = style.make_page("title", "note", grid).figure.get_figheight()
    long = [Entry("a name of a third of it all", "k") for _ in range(5)]
    page = style.make_page("title", "note", grid, long)
    [legend] = page.figure.legends
    assert legend._ncols == 2
    assert page.figure.get_figheight() - bare == pytest.approx(3 * LINE)
    assert page.figure.get_figheight() * page.rows[0][0].get_position().height == pytest.approx(2.0)


def test_ticks_of_a_logarithmic_axis_are_plain_numbers():
    axes = Figure().add_subplot()
    style.scale_log(axes, "x", 0.9, 60)
    inside = [tick for tick in axes.get_xticks() if 0.9 <= tick <= 60]
    np.testing.assert_allclose(inside, [1, 2, 5, 10, 20, 50])
    assert [axes.xaxis.get_major_formatter()(tick, 0) for tick in inside] == ["1", "2", "5", "10", "20", "50"]
    assert len(axes.xaxis.get_minorticklocs()) == 0


def test_an_empty_panel_says_why():
    axes = style.make_page("title", "note", Grid((2.0,))).rows[0][0]
    style.explain_empty(axes, "nothing was recorded")
    assert axes.texts[0].get_text() == "nothing was recorded" and len(axes.get_yticks()) == 0
