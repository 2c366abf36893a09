"""The local page in a browser: the command prints its address, a moved slider moves table and pictures."""

import subprocess
import sys

import pytest

from ..report.browser import BLANK, open_chromium, open_page


@pytest.fixture(scope="module")
def address():
    command = [sys.executable, "-m", "seatsim", "explore", "quickstart", "--no-browser"]
    with open_chromium() as browser, subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as started:
        try:
            yield browser, started.stdout.readline().strip()
        finally:
            started.terminate()


@pytest.mark.slow
def test_a_moved_slider_moves_table_and_pictures(address):
    browser, first = address
    home = first.partition("/?")[0]
    assert home.startswith("http://127.0.0.1:")
    page, complaints, requests = open_page(browser, first)
    page.wait_for_selector(".plot[data-drawn=yes]")
    assert page.evaluate(BLANK) == 0 and "token" not in page.url
    before = page.text_content("#tables"), page.evaluate("seatsimCharts[0].plots[0].data[2].slice(0, 400)")
    page.locator("input[name=mass]").press("End")
    page.wait_for_selector("main[data-shown]")
    after = page.text_content("#tables"), page.evaluate("seatsimCharts[0].plots[0].data[2].slice(0, 400)")
    assert before[0] != after[0] and before[1] != after[1] and page.text_content("#problem") == ""
    assert page.evaluate(BLANK) == 0
    assert complaints == [] and all(request.startswith(home) for request in requests)
    page.close()
