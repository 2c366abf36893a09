"""Pages, legends and text that all figures share."""

import numpy as np
from matplotlib.figure import Figure

from seatsim.plots import style
from seatsim.plots.style import Grid


def test_ticks_of_a_logarithmic_axis_are_plain_numbers_or_over_many_decades_powers_of_ten():
    axes = Figure().add_subplot()
    style.scale_log(axes, "x", 0.9, 60)
    inside = [tick for tick in axes.get_xticks() if 0.9 <= tick <= 60]
    assert [axes.xaxis.get_major_formatter()(tick, 0) for tick in inside] == ["1", "2", "5", "10", "20", "50"]
    assert len(axes.xaxis.get_minorticklocs()) == 0
    style.scale_log(axes, "y", 1e-6, 1e2)
    named = [axes.yaxis.get_major_formatter()(tick, 0) for tick in axes.get_yticks() if 1e-6 <= tick <= 1e2]
    assert named[:2] == ["10⁻⁶", "10⁻⁵"] and named[-3:] == ["1", "10", "10²"]
    style.scale_log(axes, "y", 1e-6, 9e-6)
    assert axes.yaxis.get_major_formatter()(2e-6, 0) == "2×10⁻⁶"


def test_lines_that_coincide_are_named_in_the_note_and_both_are_seen():
    looks = style.make_entries(["a", "$b$", "other"])
    figure, [[left], [right]] = style.make_page("title", "A note as long as a line." * 3, Grid((1.0, 1.0)), looks)
    x = np.linspace(0.0, 1.0, 50)
    for axes, shift in ((left, 0.0), (right, 1e-3)):
        for look, values in zip(looks, (x, x + shift, 1.0 - x), strict=True):
            style.draw_line(axes, x, values, look)
    height = figure.get_figheight()
    before = [axes.get_position().height * height for axes in figure.axes]
    style.name_coincident(figure)
    assert " ".join(figure.texts[1].get_text().split()).endswith(r"“a” and “\$b\$” coincide.")
    lower, upper, other = left.lines
    assert lower.get_linewidth() > upper.get_linewidth() and lower.get_alpha() < 1.0 == upper.get_alpha()
    assert lower.get_zorder() < upper.get_zorder() and other.get_linewidth() == looks[2].width
    samples = figure.legends[0].legend_handles
    assert samples[0].get_linewidth() == lower.get_linewidth() and samples[0].get_alpha() == lower.get_alpha()
    grown = figure.get_figheight()
    assert grown == height + style.LINE
    np.testing.assert_allclose([axes.get_position().height * grown for axes in figure.axes], before)
    right.lines[1].set_ydata(np.where(x < 0.6, x, x + 0.1))
    right.lines[0].set(linewidth=1.0)
    assert "half of their length" in style.name_coincident(figure).texts[1].get_text()
    right.lines[1].set_ydata(x + 0.1)
    left.lines[2].set_ydata(x - 9.0)
    left.set_title("first", loc="left")
    note = " ".join(style.name_coincident(figure).texts[1].get_text().split())
    assert note.endswith(r"“a” and “\$b\$” coincide (first). Nothing of “other” lies within the scales (first).")


def test_a_power_of_ten_that_numbers_share_stands_before_the_unit():
    figure, [[axes]] = style.make_page("title", "note", Grid((1.0,)))
    axes.set(ylim=(-4e-7, 4e-7), ylabel="difference [A]", xlabel="time [s]")
    figure.draw_without_rendering()
    assert (axes.get_ylabel(), axes.get_xlabel()) == ("difference [10⁻⁷ A]", "time [s]")
