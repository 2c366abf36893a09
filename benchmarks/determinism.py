"""Equal scenarios give equal bytes: 100 drawn ones on one thread and two, twice in a process and in new ones.

    python benchmarks/determinism.py [--scenarios 100] [--seed 0] [--engines]

Scenarios are drawn by the seed over dampers, laws, roads, temperatures and drivers, and run for 1 to 2 s. Each process
runs all of them twice and hashes what it wrote: `summary.csv`, `summary.json`, `history.parquet`, `report.html`, and
the pictures of every tenth. Compared are the hashes of two passes within a process, of a second process, and of one
that runs two scenarios at once with two threads for linear algebra. `--engines` draws as many points of a sweep and
compares its rows of one process, of two, and of a dask cluster of this machine, each twice.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from seatsim.cli.outputs.runs import write_interrupted, write_result
from seatsim.report.rendering import write_html
from seatsim.report.runs import report_runs
from seatsim.scenario.loading import single
from seatsim.schema.errors import SeatsimError
from seatsim.simulation.result import Result
from seatsim.simulation.runs import run_one

DAMPERS = ("modified_bouc_wen", "original_bingham", "viscous_dahl", "lugre_sakai", "kwok_tanh", "yu2019")
LAWS = (
    "{law: constant, current: 0.3}", "{law: skyhook}", "{law: hybrid}", "{law: pid}", "{law: acceleration_driven}",
    "{law: sliding_mode}",
)  # fmt: skip
SWEEP = """\
scenario: h-infinity
design: lhs
seed: 3
runs: {runs}
replicates: 2
vary:
  damper: [{dampers}]
  controller: [{laws}]
  excitation:
    - {{kind: iso7096, spectral_class: EM1, duration: 1.0}}
    - {{kind: road, road_class: C, speed: 9.0, duration: 2.0}}
  temperature: {{uniform: [0, 80]}}
  plant.driver_mass: {{uniform: [50, 110]}}
"""
ENGINES = (("local", "--jobs", "1"), ("local", "--jobs", "2"), ("dask", "--jobs", "2"))
Hashes = Mapping[str, str]


def main() -> None:
    """Compare, and fail where anything differs."""
    options = argparse.ArgumentParser()
    options.add_argument("--scenarios", type=int, default=100)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--engines", action="store_true", help="compare the engines of sweeps instead")
    options.add_argument("--worker", type=Path, help=argparse.SUPPRESS)
    options.add_argument("--threads", type=int, default=1, help=argparse.SUPPRESS)
    asked = options.parse_args()
    if asked.worker:
        print(json.dumps([hash_all(asked.worker, number, asked.threads) for number in range(2)]))
        return
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        problems = list(compare_engines(folder, asked.scenarios) if asked.engines else compare_processes(folder, asked))
    print("\n".join(problems) or "all bytes are the same")
    raise SystemExit(bool(problems))


def compare_processes(folder: Path, asked: argparse.Namespace) -> Iterator[str]:
    """Yield the files that are not the same in every process and pass."""
    generator = random.Random(asked.seed)
    for number in range(asked.scenarios):
        (folder / f"drawn-{number:03d}.yaml").write_text(draw_scenario(generator), encoding="utf-8")
    first: Hashes = {}
    for name, threads in (("first process", 1), ("second process", 1), ("two threads", 2)):
        for number, hashes in enumerate(start_worker(folder, threads)):
            first = first or hashes
            different = sorted(key for key in first.keys() | hashes.keys() if first.get(key) != hashes.get(key))
            failed = sum(value.startswith("failed") for value in hashes.values())
            print(
                f"{name}, pass {number + 1}: {len(hashes)} files, {failed} runs failed, {len(different)} differ",
                flush=True,
            )
            yield from (f"{name}, pass {number + 1}: {key}" for key in different)


def draw_scenario(generator: random.Random) -> str:
    """Return the text of a scenario."""
    road, mass = generator.choice("ABCD"), generator.uniform(50, 110)
    speed, duration = generator.uniform(4, 12), generator.choice((1, 1.5, 2))
    return f"""\
seed: {generator.randrange(1000)}
plant: {{frame_mass: 20, driver_mass: {mass:.2f}, suspension_stiffness: 4600, suspension_damping: 150,
  cushion_stiffness: 60000, cushion_damping: 1500}}
damper: {{model: {generator.choice(DAMPERS)}}}
actuator: {{rate: 130, max_current: 1.0}}
temperature: {generator.uniform(0, 80):.1f}
controller: {generator.choice(LAWS)}
excitation: {{kind: road, road_class: {road}, speed: {speed:.2f}, duration: {duration}}}
"""


def start_worker(folder: Path, threads: int) -> list[Hashes]:
    """Return the hashes of two passes of a new process."""
    command = [sys.executable, __file__, "--worker", str(folder), "--threads", str(threads)]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": str(threads), "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    found: list[Hashes] = json.loads(done.stdout)
    return found


def hash_all(folder: Path, number: int, threads: int) -> Hashes:
    """Run all scenarios and return the hashes of their files by scenario and name."""
    paths = sorted(folder.glob("drawn-*.yaml"))
    with ThreadPoolExecutor(threads) as pool, tempfile.TemporaryDirectory() as place:
        found = list(pool.map(lambda path: hash_one(path, Path(place) / path.stem), paths))
        pictured = [hash_pictures(path, Path(place) / f"{path.stem}-all") for path in paths[::10]]
    return {key: value for each in (*found, *pictured) for key, value in each.items()}


def hash_one(path: Path, out: Path) -> Hashes:
    """Run a scenario, and return the hashes of its table, histories and report, or the error that it ends with."""
    try:
        run = run_one(single(path))
    except SeatsimError as error:
        return {path.stem: f"failed: {error}"}
    files = [*write_interrupted(Result([run]), out), write_html(report_runs([run], "", path.stem), out / "report.html")]
    return hash_files(path.stem, files)


def hash_pictures(path: Path, out: Path) -> Hashes:
    """Return the hashes of all that a command would write; pictures are drawn by one thread in every case."""
    try:
        return hash_files(f"{path.stem}-all", write_result(Result([run_one(single(path))]), out))
    except SeatsimError as error:
        return {path.stem: f"failed: {error}"}


def hash_files(name: str, files: list[Path]) -> Hashes:
    """Return the hashes of files."""
    return {f"{name}/{file.name}": hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


def compare_engines(folder: Path, points: int) -> Iterator[str]:
    """Yield the engines and passes whose rows are not those of the first."""
    dampers = ", ".join(f"{{model: {name}}}" for name in DAMPERS)
    text = SWEEP.format(runs=points, dampers=dampers, laws=", ".join(LAWS))
    (folder / "sweep.yaml").write_text(text, encoding="utf-8")
    first: Hashes = {}
    for engine, *more in ENGINES:
        for number in (1, 2):
            out = folder / f"{engine}-{more[-1]}-{number}"
            words = [sys.executable, "-m", "seatsim", "sweep", str(folder / "sweep.yaml"), "--engine", engine, *more]
            # Status 1 says that runs failed, which is a row like any other.
            status = subprocess.run([*words, "--out", str(out)], check=False, stdout=subprocess.DEVNULL).returncode
            hashes = hash_files("rows", sorted(out.glob("runs/part-*.parquet")))
            first, name = first or hashes, f"{engine} {' '.join(more)}, pass {number}"
            same = bool(hashes) and status < 2 and hashes == first
            print(f"{name}: {len(hashes)} parts, {'the same' if same else 'others'}", flush=True)
            if not same:
                yield f"{name} gives other rows than {' '.join(ENGINES[0])}"


if __name__ == "__main__":
    main()
