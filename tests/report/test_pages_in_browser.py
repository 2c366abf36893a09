"""A report in a browser: pictures have drawn pixels, nothing is cut off, nothing complains, nothing is asked for."""

import pytest

from seatsim.report.diagnosis import report_diagnosis
from seatsim.report.rendering import write_html

from .browser import BLANK, open_chromium, open_page
from .diagnoses import with_every_run


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    path = write_html(report_diagnosis(with_every_run()), tmp_path_factory.mktemp("page") / "report.html")
    with open_chromium() as browser:
        yield browser, path.as_uri()


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (400, "dark")])
def test_every_picture_is_drawn_and_nothing_is_cut_off(opened, width, scheme):
    page, complaints, requests = open_page(*opened, width, scheme)
    assert page.locator(".plot").count() == page.locator(".plot[data-drawn=yes]").count() == 5
    assert page.evaluate(BLANK) == 0
    assert page.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    ends = page.evaluate("[...document.querySelectorAll('h1, p, figure')].map(e => e.getBoundingClientRect().right)")
    assert max(ends) <= width and page.locator(".pictures img").count() == 7
    assert page.evaluate("[...document.images].every(image => image.naturalWidth > 300)")
    assert complaints == [] and requests == [opened[1]]
    page.close()


def test_zoom_cursor_and_runs_are_linked_and_reached_by_keys(opened):
    page, complaints, _ = open_page(*opened)
    group = page.locator("#signals-time")
    ranges = "seatsimCharts[0].plots.map(plot => [plot.scales.x.min, plot.scales.x.max])"
    whole = page.evaluate(ranges)
    group.get_by_role("button", name="Zoom in").press("Enter")
    closer = page.evaluate(ranges)
    assert all(a == closer[0] for a in closer) and closer[0][1] - closer[0][0] < 0.6 * (whole[0][1] - whole[0][0])
    group.locator(".plot").first.press("ArrowRight")
    readouts = group.locator(".readout").all_text_contents()
    assert all(text.startswith("time ") and "measured" in text for text in readouts)
    group.locator("select").select_option("1")
    assert page.evaluate(ranges) == whole
    group.locator("input").nth(1).press("Space")
    assert page.evaluate("seatsimCharts[0].plots.every(plot => !plot.series[2].show)")
    assert complaints == []
    page.close()


def test_paper_is_light_and_whole(opened):
    page, complaints, _ = open_page(*opened, scheme="dark")
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.evaluate(BLANK) == 0 and page.locator(".buttons").first.is_hidden()
    assert len(page.pdf()) > 30_000 and complaints == []
    page.close()
