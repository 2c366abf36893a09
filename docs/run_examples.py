"""Run every example of the documentation: the fenced `sh` and `python` blocks of each page, in order, in one folder.

A block that is preceded by `<!-- not run -->` is left out. The cells of a notebook are one block; its outputs are made
anew by `jupyter nbconvert --execute --inplace`, started where `scenarios` is.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

DOCS = Path(__file__).resolve().parent
BLOCK = re.compile(r"(<!-- not run -->\n)?```(sh|python)\n(.*?)```", re.DOTALL)


def main() -> None:
    """Run the pages named on the command line, or all of them; stop at the first example that fails."""
    pages = [Path(name) for name in sys.argv[1:]] or sorted([*DOCS.glob("*.md"), *DOCS.glob("*.ipynb")])
    for page in pages:
        with tempfile.TemporaryDirectory() as folder:
            for name in ("scenarios", "docs"):
                (Path(folder) / name).symlink_to(DOCS.parent / name)
            for language, code in read_blocks(page):
                run(language, code, folder, page)


def read_blocks(page: Path) -> Iterator[tuple[str, str]]:
    """Yield language and code of each block of a page that is to be run."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        yield "python", "\n".join(cells)
    else:
        yield from ((language, code) for skipped, language, code in BLOCK.findall(text) if not skipped)


def run(language: str, code: str, folder: str, page: Path) -> None:
    """Run one block in the page's folder."""
    print(f"-- {page.name}: {code.strip().splitlines()[0]}", flush=True)
    command = ["bash", "-euc", code] if language == "sh" else [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=folder, check=False)
    if done.returncode:
        sys.exit(f"{page.name}: this example failed with {done.returncode}:\n{code}")


if __name__ == "__main__":
    main()
