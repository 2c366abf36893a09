"""The documentation says what the code does."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from seatsim.cli import app

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


def test_the_reference_is_up_to_date():
    # In a process of its own: other tests register models that are none of the package's.
    code = "import runpy, sys; sys.stdout.write(runpy.run_path(sys.argv[1])['page']())"
    builder = ROOT / "docs" / "build_reference.py"
    done = subprocess.run([sys.executable, "-c", code, str(builder)], capture_output=True, encoding="utf-8", check=True)
    assert (ROOT / "docs" / "reference.md").read_text(encoding="utf-8") == done.stdout, f"run python {builder}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_every_command_and_option_has_an_example():
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    examples = "\n".join(re.findall(r"```sh\n(.*?)```", text, re.DOTALL))
    for command in app.registered_commands:
        assert f"seatsim {command.callback.__name__} " in examples
    for option in ("--out", "--set"):
        assert option in examples


def test_the_contributors_examples_work(tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 3
    for index, block in enumerate(blocks):
        file = tmp_path / f"example_{index}.py"
        file.write_text(block)
        runpy.run_path(str(file))
