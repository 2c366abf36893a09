"""Damaged files for every reader: each must be read, or refused by one sentence, soon and without leaving anything.

    python benchmarks/fuzz_readers.py [--mutants 20000] [--only scenario recording] [--seed 0] [--limit 5]

Valid files are changed at random, by the seed: bytes are flipped, cut out, doubled or put in; words are replaced by
others that are awkward (numbers of 5000 digits, tags, aliases, deep lists, paths, null bytes); lines are dropped,
doubled and exchanged; packed files are cut. Counted are tracebacks (any error that is not one of seatsim's), mutants
that took longer than the limit in seconds, and files that a reader left behind. The first of each kind is printed.
"""

from __future__ import annotations

import argparse
import gzip
import random
import re
import shutil
import signal
import tempfile
import time
import traceback
import warnings
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple, cast

HERE = Path(__file__).resolve().parents[1]
EXAMPLES = HERE / "scenarios"
RECORDING, BENCH = EXAMPLES / "data" / "recording", EXAMPLES / "data" / "bench"
SHORT_ROWS = 600
WORDS = (
    "~", "true", "-1", "0", "1e400", "-.inf", ".nan", "1e-320", "9" * 5000, "0x" + "f" * 300, "'" * 3, '"\\0"', "[]",
    "{}", "!!bool x", "!!python/name:os.system", "!own {a: 1}", "&a [*a]", "*a", "<<", "[" * 50, "{a: " * 40,
    "a" * 70_000, "é", "../../escaped", "/etc/passwd", "/dev/zero", "nowhere.csv", ":X", "os:system", "evil.py:X",
    "{1: 2, [a]: 3}", "- - -", "? x", "|", ">", "%YAML 1.1", "---", "...", "#", "@", "`", "\t", "\x00", "\ufeff",
    "1_0", "1,5", "2024-05-01", "12:30",
)  # fmt: skip
"""What a word of a YAML file is replaced by."""
CELLS = (
    "", "nan", "inf", "-1e400", "x", "1,5", '"', "'", "1 2", "\x00", "9" * 400, "é", "#", ",", ",,", "\r", "0x1",
)  # fmt: skip
"""What a cell of a table is replaced by."""


class Reader(NamedTuple):
    """Something that reads: the valid files, which of them are changed, and the call on their folder."""

    files: Mapping[str, bytes]
    changed: tuple[str, ...]
    read: Callable[[Path], object]


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


def mutate(content: bytes, generator: random.Random) -> bytes:
    """Return content with one change."""
    if content.startswith(b"\x1f\x8b"):
        if generator.random() < 0.5:
            return _damage(content, generator)
        try:
            return gzip.compress(mutate(gzip.decompress(content), generator), 1)
        except (OSError, EOFError, zlib.error):  # an earlier change has damaged it
            return _damage(content, generator)
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return _damage(content, generator)
    choices = (_replace_word, _replace_word, _change_lines, _damage_text)
    return generator.choice(choices)(text, generator).encode("utf-8", "surrogateescape")


def _replace_word(text: str, generator: random.Random) -> str:
    """Replace a word, or a cell of a table, by an awkward one."""
    is_table = text[:400].count(",") > 8 and ":" not in text[:400]
    # Most of a table is rows; its first lines hold the names.
    end = len(text) if not is_table or generator.random() < 0.5 else min(len(text), 400)
    words = list(re.finditer(r"[^\s,\[\]{}:]+", text[:end])) if end < 100_000 else []
    if not words:
        return text + generator.choice(CELLS)
    chosen = generator.choice(words)
    new = generator.choice(CELLS if is_table else (*WORDS, generator.choice(words)[0]))
    return text[: chosen.start()] + new + text[chosen.end() :]


def _change_lines(text: str, generator: random.Random) -> str:
    """Drop, double, exchange or indent lines."""
    lines = text.splitlines(keepends=True)
    if len(lines) < 2:
        return text * 2
    first, second = generator.randrange(len(lines)), generator.randrange(len(lines))
    how = generator.randrange(4)
    if how == 0:
        del lines[first]
    elif how == 1:
        lines.insert(second, lines[first])
    elif how == 2:
        lines[first], lines[second] = lines[second], lines[first]
    else:
        lines[first] = "  " + lines[first]
    return "".join(lines)


def _damage_text(text: str, generator: random.Random) -> str:
    return _damage(text.encode(), generator).decode("utf-8", "surrogateescape")


def _damage(content: bytes, generator: random.Random) -> bytes:
    """Flip, cut out, double or put in bytes."""
    at = generator.randrange(len(content) + 1)
    size = generator.choice((1, 1, 2, 8, 64, 1000))
    how = generator.randrange(4)
    if how == 0:
        return content[:at] + content[at + size :]
    if how == 1:
        return content[:at] + content[at : at + size] * generator.choice((2, 3)) + content[at + size :]
    if how == 2:
        return content[:at]
    return content[:at] + generator.randbytes(generator.choice((1, 2, 8))) + content[at + size :]


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


def make_readers() -> dict[str, Reader]:
    """Return all readers with their valid files."""
    scenario = (EXAMPLES / "quickstart.yaml").read_bytes()
    seat = (EXAMPLES / "laws.yaml").read_bytes()
    table = b"".join(gzip.decompress((RECORDING / "run-1.csv.gz").read_bytes()).splitlines(keepends=True)[:SHORT_ROWS])
    recorded = {name: (RECORDING / name).read_bytes() for name in ("recording.yaml", "nominal.yaml")}
    recorded |= {f"run-{number}.csv.gz": gzip.compress(table, 1) for number in (1, 2)}
    bench = next(path for path in sorted(BENCH.glob("*.csv*")))
    rows = bench.read_bytes() if bench.suffix == ".csv" else gzip.decompress(bench.read_bytes())
    rows = b"".join(rows.splitlines(keepends=True)[:SHORT_ROWS])
    sidecar = b"sample_rate_Hz: 500\ntemperature_degC: 20\nnote: a sine of 1 Hz\n"
    sweep = b"scenario: quickstart.yaml\nseed: 1\ndesign: lhs\nruns: 10\n"
    sweep += b"vary:\n  plant.driver_mass: {normal: [80, 12], low: 50}\n"
    design = b"plant.driver_mass,temperature\n55,20\n75,40\n98,60\n"
    designed = b"scenario: quickstart.yaml\ndesign: table\ntable: points.csv\nlimits: {driver_acceleration_rms: 2}\n"
    return {
        "scenario": Reader({"a.yaml": scenario}, ("a.yaml",), _read_scenario),
        "variants": Reader({"a.yaml": seat}, ("a.yaml",), _read_scenario),
        "recording": Reader(recorded, ("recording.yaml", "nominal.yaml"), _read_recording),
        "table": Reader(recorded, ("run-1.csv.gz",), _read_recording),
        "bench": Reader({"a.csv": rows, "a.yaml": sidecar}, ("a.csv", "a.yaml"), _read_bench),
        "sweep": Reader({"a.yaml": sweep, "quickstart.yaml": scenario}, ("a.yaml",), _read_sweep),
        "design": Reader(
            {"a.yaml": designed, "points.csv": design, "quickstart.yaml": scenario},
            ("a.yaml", "points.csv"),
            _read_sweep,
        ),
        "import": Reader({"a.csv": table}, ("a.csv",), _read_import),
        "formats": Reader(_formats(table), tuple(_formats(table)), _read_formats),
        "synthesis": Reader({"design.yaml": _design()}, ("design.yaml",), _read_design),
        "diagnosis": Reader({"diagnosis.json": _diagnosis()}, ("diagnosis.json",), _read_diagnosis),
        "sealed": Reader(_sealed(), ("sealed", "folder-seal.txt"), _read_sealed),
    }


def _read_scenario(folder: Path) -> object:
    from seatsim.scenario.loading import load

    return load(folder / "a.yaml")


def _read_recording(folder: Path) -> object:
    from seatsim.recordings.recording import load_recording
    from seatsim.scenario.loading import single

    recording = load_recording(folder)
    tables = [recording.table(run) for run in recording.runs]
    return tables, single(recording.nominal)


def _read_bench(folder: Path) -> object:
    from seatsim.recordings.bench_tables import load_bench

    return load_bench(folder / "a.csv")


def _read_sweep(folder: Path) -> object:
    from seatsim.sweeps.execute import prepare

    return prepare(folder / "a.yaml")


def _read_import(folder: Path) -> object:
    from seatsim.importing.inspection import inspect_file

    return inspect_file(folder / "a.csv")


def _read_formats(folder: Path) -> object:
    from seatsim.importing.inspection import inspect_file
    from seatsim.schema.errors import SeatsimError

    last: Exception | None = None
    for path in sorted(folder.iterdir()):
        try:
            inspect_file(path)
        except SeatsimError as error:
            last = error
    if last is not None:
        raise last
    return None


def _read_design(folder: Path) -> object:
    from controllers.synthesis.design import Design

    return Design.load(folder / "design.yaml").gamma


def _read_diagnosis(folder: Path) -> object:
    from seatsim.blind.score.verdicts import read_verdict

    return read_verdict(folder / "diagnosis.json")


def _read_sealed(folder: Path) -> object:
    from seatsim.blind.sealed import unseal

    (folder / "set").mkdir(exist_ok=True)
    (folder / "folder-seal.txt").rename(folder / "set" / "seal.txt")
    try:
        return unseal(folder / "sealed", KEY, folder / "set")
    finally:
        (folder / "set" / "seal.txt").rename(folder / "folder-seal.txt")
        (folder / "set").rmdir()


KEY = "c2VhdHNpbS1mdXp6LXJlYWRlcnMtMzItYnl0ZXMhISE="
"""A key for the sealed file."""


def _formats(table: bytes) -> dict[str, bytes]:
    """Return the table in the formats whose libraries are there."""
    import io

    import pandas as pd
    import scipy.io

    frame = pd.read_csv(io.BytesIO(table)).head(200)
    files: dict[str, bytes] = {}
    for name, write in (("a.parquet", frame.to_parquet), ("a.feather", frame.to_feather)):
        packed = io.BytesIO()
        write(packed)
        files[name] = packed.getvalue()
    packed = io.BytesIO()
    scipy.io.savemat(cast("str", packed), {str(name): frame[name].to_numpy() for name in frame})
    files["a.mat"] = packed.getvalue()
    return files


def _design() -> bytes:
    """Return a design of a plant of two states."""
    import numpy as np

    from controllers.synthesis import synthesise

    with tempfile.TemporaryDirectory() as place:
        two, one = np.eye(2), np.ones((1, 1))
        found = synthesise(
            np.array([[0.0, 1.0], [-4.0, -0.4]]), np.array([[0.0], [1.0]]), np.array([[0.0], [1.0]]), two, two,
            np.zeros((2, 1)), 0.1 * np.vstack([one, one]), np.zeros((2, 1)), time_budget=2.0,
        )  # fmt: skip
        found.save(Path(place) / "design.yaml")
        return (Path(place) / "design.yaml").read_bytes()


def _diagnosis() -> bytes:
    return (
        b'{"verdict": "known", "where": [{"block": "damper", "share": 0.9}], "causes": [{"effect": "damper.remanence",'
        b' "probability": 0.97, "shrink": 0.87, "parameters": {"width": {"value": 0.08, "std": 0.004, "unit": "A"}}}],'
        b' "selected": ["damper.remanence"], "indistinguishable": [], "experiment": null, "held_out": ["run-c"],'
        b' "gap": {"before": {"overall": 0.31, "channels": {"damper_force": 0.4}}, "shrink": 0.87,'
        b' "shrink_interval": [0.82, 0.9]}, "augmented": "augmented.yaml"}'
    )


def _sealed() -> dict[str, bytes]:
    from seatsim.blind.sealed import SEAL, Sealed, seal

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "set"
        folder.mkdir()
        seal(Path(place) / "sealed", folder, KEY, Sealed({}, {"case-0001": {"run.csv": b"a\n1\n"}}, {"seed": 1}))
        return {"sealed": (Path(place) / "sealed").read_bytes(), "folder-seal.txt": (folder / SEAL).read_bytes()}


if __name__ == "__main__":
    main()
