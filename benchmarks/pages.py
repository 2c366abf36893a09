"""What reports and the local page are worth in a browser: size, first picture, complaints, requests, accessibility.

    python benchmarks/pages.py reports FOLDER [--axe axe.min.js]     every *.html below a folder
    python benchmarks/pages.py explore TARGET [--axe axe.min.js]     the page of a scenario or a recording

Needs Playwright and a Chromium. `axe.min.js` is of the npm package axe-core; without it accessibility is not judged.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking"]
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
LOOKS = [(width, scheme) for width in (1280, 400) for scheme in ("light", "dark")]
MOVES = 20


def main() -> None:
    """Print a line for each page and look, or the times of the local page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["reports", "explore"])
    parser.add_argument("target")
    parser.add_argument("--axe", type=Path)
    given = parser.parse_args()
    axe = given.axe.read_text(encoding="utf-8") if given.axe else ""
    with open_browser() as browser:
        if given.what == "explore":
            measure_page(browser, given.target, axe)
        else:
            for path in sorted(Path(given.target).rglob("*.html")):
                measure_report(browser, path, axe)


@contextmanager
def open_browser() -> Iterator[Browser]:
    """Yield a headless Chromium."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        yield browser
        browser.close()


def measure_report(browser: Browser, path: Path, axe: str) -> None:
    """Print what a report needs and what is wrong with it, in every look and printed."""
    for width, scheme in LOOKS:
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)  # type: ignore[arg-type]  # one of LOOKS
        said, asked = watch(page)
        began = time.perf_counter()
        page.goto(path.as_uri())
        if page.query_selector(".plot"):
            page.wait_for_selector(".plot[data-drawn]")
        first = time.perf_counter() - began
        beyond = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        print(
            f"{path.parent.name}/{path.name} {path.stat().st_size / 1e3:.0f} kB, {width} px {scheme}: first picture"
            f" {first:.2f} s, {beyond} px cut off, {len(said)} complaints, {len(asked) - 1} requests,"
            f" axe {judge(page, axe)}, printed {len(page.pdf()) / 1e3:.0f} kB"
        )
        page.close()


def measure_page(browser: Browser, target: str, axe: str) -> None:
    """Print how fast the local page starts, and the time from a moved slider to the new curve."""
    began = time.perf_counter()
    command = [sys.executable, "-m", "seatsim", "explore", target, "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as started:
        assert started.stdout is not None
        address = started.stdout.readline().strip()
        print(f"address after {time.perf_counter() - began:.2f} s")
        with urllib.request.build_opener(urllib.request.HTTPCookieProcessor()).open(address) as answer:
            print(f"answered after {time.perf_counter() - began:.2f} s ({answer.status})")
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        said, asked = watch(page)
        page.goto(address)
        page.wait_for_selector(".plot[data-drawn]")
        print(f"first picture after {time.perf_counter() - began:.2f} s")
        if page.query_selector(".effect"):
            page.locator(".effect input[type=checkbox]").first.check()
            page.wait_for_selector("main[data-shown='1']")
        done = 1 if page.query_selector(".effect") else 0
        slider = page.locator("input[type=range]:visible").first
        times = []
        for move in range(done + 1, done + MOVES + 1):
            moved = time.perf_counter()
            slider.press("ArrowRight")
            page.wait_for_selector(f"main[data-shown='{move}']")
            times.append(time.perf_counter() - moved)
        foreign = [url for url in asked if not url.startswith(address.partition("/?")[0])]
        print(f"slider to new curve: median {statistics.median(times):.3f} s, slowest {max(times):.3f} s of {MOVES}")
        print(f"{len(said)} complaints, {len(foreign)} foreign requests, axe {judge(page, axe)}")
        page.close()
        started.terminate()


def watch(page: Page) -> tuple[list[str], list[str]]:
    """Return lists that fill with what a page complains of and asks for."""
    said: list[str] = []
    asked: list[str] = []
    page.on("console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    return said, asked


def judge(page: Page, axe: str) -> str:
    """Return the rules that axe-core finds violated."""
    if not axe:
        return "not run"
    page.evaluate(axe)
    run = f"axe.run(document, {{runOnly: {RULES}}}).then(found => found.violations.map(each => each.id))"
    return ", ".join(page.evaluate(run)) or "clean"


if __name__ == "__main__":
    main()
