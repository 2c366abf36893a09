"""Damaged files for every reader: each must be read, or refused by one sentence, soon and without leaving anything.

    python benchmarks/fuzz_readers.py [--mutants 20000] [--only scenario recording] [--seed 0] [--limit 5]

Valid files are changed at random, by the seed: bytes are flipped, cut out, doubled or put in; words are replaced by
others that are awkward (numbers of 5000 digits, tags, aliases, deep lists, paths, null bytes); lines are dropped,
doubled and exchanged; packed files are cut. Counted are tracebacks (any error that is not one of seatsim's), mutants
that took longer than the limit in seconds, and files that a reader left behind. The first of each kind is printed.
"""

from __future__ import annotations

import argparse
import random
import shutil
import signal
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from fuzz_cases import Reader, make_readers
from fuzz_mutations import mutate


class Found(NamedTuple):
    """What went wrong, by reader and kind; `examples` holds the first of each kind with the traceback."""

    counts: Counter[str]
    examples: dict[str, str]


class TooLongError(BaseException):
    """A mutant took longer than the limit."""


def main() -> None:
    """Print the counts and the first mutant of each kind; fail where anything went wrong."""
    options = argparse.ArgumentParser()
    options.add_argument("--mutants", type=int, default=20_000, help="mutants of each reader")
    options.add_argument("--only", nargs="*", help="readers")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--limit", type=float, default=5.0, help="seconds that a mutant may take")
    asked = options.parse_args()
    readers = make_readers()
    failed = False
    for name in asked.only or readers:
        start = time.perf_counter()
        found = fuzz(readers[name], asked.mutants, asked.seed, asked.limit)
        bad = {kind: count for kind, count in found.counts.items() if kind not in ("read", "refused")}
        failed |= bool(bad)
        print(f"{name}: {dict(found.counts)} in {time.perf_counter() - start:.0f} s", flush=True)
        for kind in bad:
            print(f"--- {kind}\n{found.examples[kind]}", flush=True)
    raise SystemExit(failed)


def fuzz(reader: Reader, mutants: int, seed: int = 0, limit: float = 5.0) -> Found:
    """Read so many mutants of a reader's files, each in a folder of its own."""
    from seatsim.schema.errors import SeatsimError

    found = Found(Counter(), {})
    with tempfile.TemporaryDirectory() as place:
        for number in range(mutants):
            folder = Path(place) / "mutant"
            generator = random.Random(f"{seed} {number}")
            files = dict(reader.files)
            name = generator.choice(reader.changed)
            for _ in range(generator.choice((1, 1, 1, 2, 3))):
                files[name] = mutate(files[name], generator)
            folder.mkdir()
            for each, content in files.items():
                (folder / each).parent.mkdir(parents=True, exist_ok=True)
                (folder / each).write_bytes(content)
            before = sorted(folder.rglob("*"))
            kind, said = "read", ""
            try:
                with warnings.catch_warnings(), time_limit(limit):
                    warnings.simplefilter("ignore")
                    reader.read(folder)
            except SeatsimError as error:
                kind = "refused"
                said = str(error)
                if "\n" in said or len(said) > 3000:
                    kind = "a message that is no sentence"
            except TooLongError:
                kind, said = "longer than the limit", f"mutant {number}"
            except Exception as error:
                kind = f"traceback {type(error).__name__} in {_place_of(error)}"
                said = "".join(traceback.format_exception(error)[-6:])
            if kind == "refused" and sorted(folder.rglob("*")) != before:
                kind = "files left"
            found.counts[kind] += 1
            found.examples.setdefault(kind, f"mutant {number} of {name}\n{said[-3000:]}")
            shutil.rmtree(folder)
    return found


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `TooLongError` after so many seconds, where signals can."""

    def stop(*_: object) -> None:
        raise TooLongError

    previous = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)


def _place_of(error: Exception) -> str:
    """Return where an error comes from: the last line of seatsim in its traceback."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "/seatsim/" in frame.filename]
    return f"{Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else "no line of seatsim"


if __name__ == "__main__":
    main()
