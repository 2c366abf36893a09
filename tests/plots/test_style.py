"""Pages, legends and text that all figures share."""

from matplotlib.figure import Figure

from seatsim.plots import style


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
