"""Figures as files: by their ending, and with equal bytes for equal figures."""

from urllib.parse import unquote

import pytest
from matplotlib.figure import Figure

from seatsim.plots.saving import OPTIONS, render_inline, save_figure
from seatsim.plots.style import Grid, make_page

STARTS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", OPTIONS)
def test_the_ending_chooses_the_format_and_equal_figures_give_equal_bytes(tmp_path, ending):
    contents = []
    for name in ("a", "b"):
        figure = Figure()
        figure.add_subplot().plot([0, 1], [1, 0], label="line")
        save_figure(figure, tmp_path / f"{name}{ending}")
        contents.append((tmp_path / f"{name}{ending}").read_bytes())
    assert contents[0].startswith(STARTS[ending]) and contents[0] == contents[1]
    # The version of the library would change the bytes.
    assert ending != ".png" or b"matplotlib" not in contents[0]


def test_texts_of_an_inline_picture_keep_their_digits():
    page = make_page("title", "note", Grid((1.0,)))
    page.rows[0][0].text(0.5, 0.5, "mass: 0.00125 kg")
    assert ">mass: 0.00125 kg<" in unquote(render_inline(page.figure).source)
