"""What a page says that an example prints is compared with what it prints."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))

from run_examples import ExampleError, find_missing, read_blocks, run_page  # noqa: E402

SAID = "name      RMS [m/s²]\nseat-1        1.272\nseat-2        0.990\n\nverdict: known, shrink 0.64 (99% of it)\n"


@pytest.mark.parametrize(
    "shown, tolerance, missing",
    [
        (SAID, 0.0, None),
        ("seat-1   1.272\n...\nverdict: known, shrink 0.64 (99% of it)\n", 0.0, None),
        ("│ seat-1 │ 1.272 │\n", 0.0, None),
        ("seat-1   1.273\n", 0.0, "seat-1   1.273"),
        ("seat-1   1.273\n", 0.01, None),
        ("seat-1   1.300\n", 0.01, "seat-1   1.300"),
        ("seat-2   0.990\nseat-1   1.272\n", 0.0, "seat-1   1.272"),
        ("verdict: unknown, shrink 0.64 (99% of it)\n", 0.5, "verdict: unknown, shrink 0.64 (99% of it)"),
        ("verdict: known, shrink 0.64 (99% of it) 1\n", 0.5, "verdict: known, shrink 0.64 (99% of it) 1"),
    ],
)
def test_every_line_that_is_shown_must_be_printed_in_its_order(shown, tolerance, missing):
    assert find_missing(shown, SAID, tolerance) == missing


def test_a_page_that_shows_another_figure_fails(tmp_path):
    page = tmp_path / "page.md"
    text = "```sh\nprintf 'gap 0.13\\nnoise 0.02\\n'\n```\n\n<!-- printed -->\n```text\ngap 0.13\n```\n"
    page.write_text(text)
    assert "2 blocks" in run_page(page)
    page.write_text(text.replace("gap 0.13\n```", "gap 0.143\n```"))
    with pytest.raises(ExampleError, match=r"gap 0\.143"):
        run_page(page)


def test_every_block_of_output_is_compared():
    for page in sorted((ROOT / "docs").glob("*.md")):
        shown = page.read_text(encoding="utf-8").count("```text\n")
        compared = [block.language for block in read_blocks(page)].count("text")
        assert compared == shown or page.name == "architecture.md", page.name


def test_the_front_page_shows_the_table_of_the_tutorial():
    tables = [
        (ROOT / page).read_text(encoding="utf-8").split("```text\n")[1] for page in ("README.md", "docs/tutorial.md")
    ]
    assert tables[0].partition("```")[0] == tables[1].partition("```")[0]
