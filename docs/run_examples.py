"""Run every example of the documentation: the fenced `sh` and `python` blocks of each page, in order, in one folder.

Two pages are run at once, since much of an example is start-up and compilation on one core. What a block prints is
shown where it fails.

A block that is preceded by `<!-- not run -->` is left out. A `text` block that is preceded by `<!-- printed -->` is
compared with what the last example before it printed on a terminal of 100 columns: every line of it must be there, in
this order; `...` stands for lines that are left out. After `<!-- printed, within 5 % -->` numbers may differ by as
much, since they do between machines. The cells of a notebook are one block; its outputs are made anew by
`jupyter nbconvert --execute --inplace`, started where `scenarios` is.
"""

from __future__ import annotations

import json
import os
import pty
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

DOCS = Path(__file__).resolve().parent
AT_ONCE = 2
BLOCK = re.compile(r"(?:<!-- (not run|printed)(?:, within ([\d.]+) %)? -->\n)?```(sh|python|text)\n(.*?)```", re.DOTALL)
CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
FRAME = re.compile("[\u2500-\u257f]")
"""Lines of a table, which a page need not show."""
MOST_SHOWN = 3000
"""Letters of what was printed that an error quotes, from its end."""
NUMBER = re.compile(r"(\d+(?:\.\d+)?)")


class ExampleError(Exception):
    """An example that failed, with its code and what it printed."""


class Block(NamedTuple):
    """A block of a page: `sh`, `python` or `text`, its content, and the part by which printed numbers may differ."""

    language: str
    content: str
    tolerance: float


def main() -> None:
    """Run the pages named on the command line, or all of them; the first example that fails ends it."""
    pages = [Path(name) for name in sys.argv[1:]] or sorted([*DOCS.glob("*.md"), *DOCS.glob("*.ipynb")])
    with ThreadPoolExecutor(AT_ONCE) as pool:
        runs = [pool.submit(run_page, page) for page in pages]
        for run in as_completed(runs):
            try:
                print(run.result(), flush=True)
            except ExampleError as error:
                pool.shutdown(cancel_futures=True)
                sys.exit(str(error))


def run_page(page: Path) -> str:
    """Run the blocks of a page in a folder of its own; return a line on it.

    Raises:
        ExampleError: a block failed, or printed something else than the page says.
    """
    begun, blocks, said = time.monotonic(), list(read_blocks(page)), ""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("scenarios", "docs"):
            (Path(folder) / name).symlink_to(DOCS.parent / name)
        for block in blocks:
            if block.language != "text":
                said = run_block(block, folder, page)
            elif (missing := find_missing(block.content, said, block.tolerance)) is not None:
                raise ExampleError(
                    f"{page.name}: this line is not printed:\n{missing}\n\nprinted is\n{said[-MOST_SHOWN:]}"
                )
    return f"-- {page.name}: {len(blocks)} blocks in {time.monotonic() - begun:.0f} s"


def read_blocks(page: Path) -> Iterator[Block]:
    """Yield the blocks of a page that are to be run or compared."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        yield Block("python", "\n".join(cells), 0.0)
    else:
        for mark, percent, language, content in BLOCK.findall(text):
            if mark == ("printed" if language == "text" else ""):
                yield Block(language, content, float(percent or 0.0) / 100.0)


def run_block(block: Block, folder: str, page: Path) -> str:
    """Run one block in the page's folder, and return what it printed on a terminal of 100 columns.

    Raises:
        ExampleError: it failed.
    """
    command = ["bash", "-euc", block.content] if block.language == "sh" else [sys.executable, "-c", block.content]
    terminal, end = pty.openpty()
    with subprocess.Popen(
        command, cwd=folder, stdin=subprocess.DEVNULL, stdout=end, stderr=end, env=os.environ | {"COLUMNS": "100"}
    ) as process:
        os.close(end)
        said = CONTROL.sub("", _read_all(terminal).decode(errors="replace")).replace("\r", "\n")
    if process.returncode:
        raise ExampleError(
            f"{page.name}: this example failed with {process.returncode}:\n{block.content}\n{said[-MOST_SHOWN:]}"
        )
    return said


def _read_all(terminal: int) -> bytes:
    read = b""
    try:
        while part := os.read(terminal, 1 << 16):
            read += part
    except OSError:  # how Linux says that the last program at the other end has gone
        pass
    finally:
        os.close(terminal)
    return read


def find_missing(shown: str, said: str, tolerance: float) -> str | None:
    """Return the first line of a page's block that was not printed after those before it, None where all were."""
    lines = iter(said.splitlines())
    for line in shown.splitlines():
        if line.strip() != "..." and not any(is_same(line, each, tolerance) for each in lines):
            return line
    return None


def is_same(shown: str, said: str, tolerance: float) -> bool:
    """Whether two lines are the same but for blanks and frames, and for numbers that differ by a part of them."""
    pairs = zip(*(NUMBER.split(" ".join(FRAME.sub(" ", line).split())) for line in (shown, said)), strict=False)
    same = all(
        abs(float(a) - float(b)) <= tolerance * abs(float(a)) if k % 2 else a == b for k, (a, b) in enumerate(pairs)
    )
    return same and len(NUMBER.findall(shown)) == len(NUMBER.findall(said))


if __name__ == "__main__":
    main()
