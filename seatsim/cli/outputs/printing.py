"""Reports printed to PDF, where `--pdf` asks for it: by a browser that is found on this machine, or by WeasyPrint."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from functools import partial
from pathlib import Path

from seatsim.schema.errors import InputError, RunError
from seatsim.schema.files import write_whole
from seatsim.schema.guarded import temporary_folder

_BROWSERS = Path(__file__).with_name("browsers.yaml")
_LONGEST = 120.0
"""s after which a browser that has not printed is given up."""
_Printer = Callable[[Path, Path], object]
_printer: ContextVar[_Printer | None] = ContextVar("printer", default=None)


def choose_printer(wanted: bool) -> bool:
    """Find what prints while options are read, before anything runs; return what was wanted.

    Raises:
        InputError: this machine has nothing that can print a page.
    """
    _printer.set(_find_printer() if wanted else None)
    return wanted


def print_reports(paths: Sequence[Path]) -> list[Path]:
    """Return some files that were written, with a PDF beside each report where one is asked for.

    Raises:
        RunError: the report could not be printed; the files that were written stay.
    """
    printer = _printer.get()
    reports = [path for path in paths if path.suffix == ".html"] if printer else []
    return [*paths, *(write_whole(path.with_suffix(".pdf"), partial(printer, path)) for path in reports if printer)]


def _find_printer() -> _Printer:
    from seatsim.schema.fields import read_packaged

    browser = next(filter(None, map(shutil.which, read_packaged(_BROWSERS, list[str]))), None)
    if browser is not None:
        return partial(_print_by_browser, browser)
    try:
        from weasyprint import HTML
    except ImportError:
        raise InputError(
            "--pdf: neither a browser that prints (Chromium, Chrome or Edge) nor WeasyPrint is on this machine; install"
            " one of them (pip install weasyprint), or print report.html from any browser"
        ) from None
    return lambda report, target: HTML(filename=str(report)).write_pdf(str(target))


def _print_by_browser(browser: str, report: Path, target: Path) -> None:
    # Root, as in a container, has no sandbox; the page lets no script but its own run.
    as_root = ["--no-sandbox"] if getattr(os, "geteuid", lambda: 1)() == 0 else []
    with temporary_folder() as profile:
        plain = ["--headless", "--disable-gpu", *as_root, "--no-pdf-header-footer", "--virtual-time-budget=20000"]
        places = [f"--user-data-dir={profile}", f"--print-to-pdf={target.resolve()}", report.resolve().as_uri()]
        command = [browser, *plain, *places]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=_LONGEST, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise RunError(f"{report}: was not printed: {error}") from error
    if done.returncode or not target.is_file() or not target.stat().st_size:
        last = done.stderr.strip().splitlines()[-1:] or ["it wrote nothing"]
        raise RunError(f"{report}: was not printed: {Path(browser).name} says: {last[0]}")
