"""Pages, legends and text that all figures share."""

import numpy as np
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.labels import clean_text
from seatsim.plots.style import Grid


def test_a_text_is_cut_in_the_middle_and_never_a_formula():
    assert clean_text("abcdefghij", 6) == "ab…hij"
    assert clean_text("_hidden", 20) == " _hidden"
    assert clean_text("$x$", 20) == r"\$x\$"


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
