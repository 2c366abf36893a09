"""Run every example of the documentation: the fenced `sh` and `python` blocks of each page, in order, in one folder.

Two pages are run at once, since much of an example is start-up and compilation on one core. What a block prints is
shown where it fails.

A block that is preceded by `<!-- not run -->` is left out. The cells of a notebook are one block; its outputs are made
anew by `jupyter nbconvert --execute --inplace`, started where `scenarios` is.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

DOCS = Path(__file__).resolve().parent
AT_ONCE = 2
BLOCK = re.compile(r"(<!-- not run -->\n)?```(sh|python)\n(.*?)```", re.DOTALL)


class ExampleError(Exception):
    """An example that failed, with its code and what it printed."""


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
        ExampleError: a block failed.
    """
    begun, blocks = time.monotonic(), list(read_blocks(page))
    with tempfile.TemporaryDirectory() as folder:
        for name in ("scenarios", "docs"):
            (Path(folder) / name).symlink_to(DOCS.parent / name)
        for language, code in blocks:
            run_block(language, code, folder, page)
    return f"-- {page.name}: {len(blocks)} blocks in {time.monotonic() - begun:.0f} s"


def read_blocks(page: Path) -> Iterator[tuple[str, str]]:
    """Yield language and code of each block of a page that is to be run."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        yield "python", "\n".join(cells)
    else:
        yield from ((language, code) for skipped, language, code in BLOCK.findall(text) if not skipped)


def run_block(language: str, code: str, folder: str, page: Path) -> None:
    """Run one block in the page's folder.

    Raises:
        ExampleError: it failed.
    """
    command = ["bash", "-euc", code] if language == "sh" else [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=folder, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise ExampleError(f"{page.name}: this example failed with {done.returncode}:\n{code}\n{done.stdout}")


if __name__ == "__main__":
    main()
