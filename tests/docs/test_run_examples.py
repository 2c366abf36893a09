"""What a page says that an example prints is compared with what it prints."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))

from run_examples import ExampleError, read_blocks, run_page  # noqa: E402


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
