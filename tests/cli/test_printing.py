"""A report printed to PDF by what this machine has."""

from importlib.util import find_spec

import pytest

from seatsim.cli.outputs import printing
from seatsim.scenario.loading import EXAMPLES
from seatsim.schema.errors import InputError, RunError

BROWSER = """#!/bin/sh
for given in "$@"; do
  case "$given" in --print-to-pdf=*) target="${given#*=}";; file://*) page="${given#file://}";; esac
done
%s
"""
RECORDING = next(path for path in EXAMPLES if path.is_dir()) / "data" / "recording"


@pytest.fixture
def browser(tmp_path, monkeypatch):
    """Put a browser that runs some line of a shell on a machine that has no other."""
    path = tmp_path / "bin" / "browser"

    def install(line):
        path.parent.mkdir()
        path.write_text(BROWSER % line)
        path.chmod(0o755)

    (tmp_path / "browsers.yaml").write_text(f"- {path}")
    monkeypatch.setattr(printing, "_BROWSERS", tmp_path / "browsers.yaml")
    yield install
    printing.choose_printer(False)


def test_a_report_is_printed_beside_the_others(browser, tmp_path, seatsim_command):
    browser('{ printf "%%PDF-1.4 "; wc -c < "$page"; } > "$target"')
    out = tmp_path / "out"
    status, said, _ = seatsim_command("gap", "--pdf", RECORDING / "nominal.yaml", RECORDING, "--out", out)
    assert status == 0 and "report.pdf" in said.replace("\n", "")
    assert (out / "report.pdf").read_text().split() == ["%PDF-1.4", str((out / "report.html").stat().st_size)]
    assert "report.pdf" not in (out / "manifest.json").read_text()


def test_without_a_printer_nothing_is_done(browser, tmp_path, seatsim_command):
    if find_spec("weasyprint"):
        pytest.skip("WeasyPrint prints here")
    status, _, said = seatsim_command("gap", "--pdf", RECORDING / "nominal.yaml", RECORDING, "--out", tmp_path / "out")
    assert status == 2 and "pip install weasyprint" in said and not (tmp_path / "out").exists()
    with pytest.raises(InputError, match="from any browser"):
        printing.choose_printer(True)


@pytest.mark.parametrize(("line", "words"), [("echo broken >&2; exit 3", "broken"), ("exit 0", "wrote nothing")])
def test_a_browser_that_fails_leaves_the_report(line, words, browser, tmp_path):
    browser(line)
    printing.choose_printer(True)
    report = tmp_path / "report.html"
    report.write_text("<p>x</p>")
    with pytest.raises(RunError, match=words):
        printing.print_reports([report])
    assert report.exists() and not report.with_suffix(".pdf").exists()
