"""A ten-minute edition of all benchmarks: `python benchmarks/run_all.py [--only NAME ...] [--out DIR]`.

Each is a process of its own; `README.md` beside this file says what each proves, and how it is run in full. Measured
data are taken from `../shared`; what needs them is left out where they are not there, as is what needs a program that
is not installed. What a benchmark prints stands in `DIR/NAME.txt`, a summary of all in the terminal.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from pydantic import TypeAdapter
from ruamel.yaml import YAML

HERE = Path(__file__).resolve().parent
SHARED = HERE.parents[1] / "shared"


class Edition(NamedTuple):
    """Arguments of a benchmark, the command that makes what it reads, and whether it needs measured data."""

    arguments: str = ""
    needs: str = ""
    measured: bool = False


EDITIONS = TypeAdapter(dict[str, Edition]).validate_python(YAML(typ="safe").load(HERE / "run_all.yaml"))


def run(name: str, out: Path) -> str:
    """Run the edition of a benchmark, and return how it ended."""
    edition = EDITIONS[name]
    if edition.measured and not SHARED.is_dir():
        return "left out: no measured data"
    key, begun = "", time.perf_counter()
    if edition.needs:
        note = out / f"{name}-made.txt"
        command = ["-m", "seatsim", *edition.needs.format(out=out).split()]
        made = note.read_text(encoding="utf-8") if note.exists() else call(command, note)
        key = next(iter(re.findall(r"key \(shown once\): (\S+)", made)), "")
    arguments = edition.arguments.format(out=out, shared=SHARED, key=key).split()
    said = call([str(HERE / f"{name}.py"), *arguments], out / f"{name}.txt")
    ended = "FAILED" if "Traceback" in said else said.strip().splitlines()[-1][:80]
    return f"{time.perf_counter() - begun:.0f} s: {ended}"


def call(arguments: list[str], note: Path) -> str:
    """Run Python with arguments, and return what it prints, which also stands in `note`."""
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False)
    note.write_text(done.stdout + done.stderr, encoding="utf-8")
    return done.stdout + (done.stderr if done.returncode else "")


def main() -> None:
    """Run the editions, and print a line for each."""
    parser = argparse.ArgumentParser(description="a ten-minute edition of all benchmarks")
    parser.add_argument("--only", nargs="+", choices=EDITIONS, default=list(EDITIONS), metavar="NAME")
    parser.add_argument("--out", type=Path, default=Path("out/benchmarks"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.only:
        print(f"{name:20} {run(name, options.out.resolve())}", flush=True)


if __name__ == "__main__":
    main()
