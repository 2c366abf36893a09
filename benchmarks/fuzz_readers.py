"""Damaged files for every reader: each must be read, or refused by one sentence, soon and without leaving anything.

    python benchmarks/fuzz_readers.py [--mutants 20000] [--only scenario recording] [--seed 0] [--limit 5]

Valid files are changed at random, by the seed: bytes are flipped, cut out, doubled or put in; words are replaced by
others that are awkward (numbers of 5000 digits, tags, aliases, deep lists, paths, null bytes); sizes, dimensions and
addresses of binary files by others; lines are dropped, doubled and exchanged; packed files are cut. Counted are
tracebacks (any error that is not one of seatsim's), deaths of the process, mutants that took longer than the limit in
seconds or more than 1 GiB of memory, and files that a reader left behind. The first of each kind is printed.
"""

from __future__ import annotations

import argparse
import random
import resource
import shutil
import signal
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from fuzz_cases import Reader, make_readers
from fuzz_mutations import mutate

MOST_MEMORY = 2**30


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
    """Read so many mutants of a reader's files, each in a folder of its own; go on after one that ends the process."""
    found = Found(Counter(), {})
    number = 0
    while number < mutants:
        for kind, example in _read_apart(reader, range(number, mutants), seed, limit):
            found.counts[kind] += 1
            found.examples.setdefault(kind, example)
            number += 1
    return found


def _read_apart(reader: Reader, numbers: range, seed: int, limit: float) -> Iterator[tuple[str, str]]:
    """Yield what became of each mutant, read in a child process; the last is the one that it died of."""
    context = get_context("fork")
    receiving, sending = context.Pipe(duplex=False)
    child = context.Process(target=_read_mutants, args=(reader, numbers, seed, limit, sending))
    child.start()
    sending.close()
    number = numbers.start
    while number < numbers.stop:
        try:
            yield receiving.recv()
        except EOFError:
            child.join()
            yield f"death of the process, status {child.exitcode}", f"mutant {number}"
            return
        number += 1
    child.join()


def _read_mutants(reader: Reader, numbers: range, seed: int, limit: float, sending: Connection) -> None:
    with tempfile.TemporaryDirectory() as place:
        for number in numbers:
            folder = Path(place) / "mutant"
            generator = random.Random(f"{seed} {number}")
            files = dict(reader.files)
            name = generator.choice(reader.changed)
            for _ in range(generator.choice((1, 1, 1, 2, 3))):
                files[name] = mutate(files[name], generator)
            for each, content in files.items():
                (folder / each).parent.mkdir(parents=True, exist_ok=True)
                (folder / each).write_bytes(content)
            before = _peak_memory()
            kind, said = _read_mutant(reader, folder, limit)
            if _peak_memory() > max(before, MOST_MEMORY):
                kind = "more memory than 1 GiB"
            sending.send((kind, f"mutant {number} of {name}\n{said[-3000:]}"))
            shutil.rmtree(folder)


def _peak_memory() -> int:
    """Return the bytes that this process has taken at most so far."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _read_mutant(reader: Reader, folder: Path, limit: float) -> tuple[str, str]:
    """Return the kind of what became of a mutant, and what was said."""
    from seatsim.schema.errors import SeatsimError

    before = sorted(folder.rglob("*"))
    try:
        with warnings.catch_warnings(), time_limit(limit):
            warnings.simplefilter("ignore")
            reader.read(folder)
    except SeatsimError as error:
        said = str(error)
        if "\n" in said or len(said) > 3000:
            return "a message that is no sentence", said
        return "refused" if sorted(folder.rglob("*")) == before else "files left", said
    except TooLongError:
        return "longer than the limit", ""
    except Exception as error:
        said = "".join(traceback.format_exception(error)[-6:])
        return f"traceback {type(error).__name__} in {_place_of(error)}", said
    return "read", ""


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
