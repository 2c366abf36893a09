"""Kill a sweep at random moments and compare what a resumed one holds with an undisturbed one, bit for bit.

    python benchmarks/sweep_kills.py [KILLS] [--victim command|worker|scheduler] [--seed N]

Each kill is `kill -9`, at a moment that is uniform over the runs of an undisturbed sweep: of the command itself, of a
worker of a dask cluster, which the sweep survives, or of its scheduler, which ends the command. Then the sweep is
resumed until it is complete, and its parts and manifest are compared. Prints a line for each kill and a summary.
"""

from __future__ import annotations

import argparse
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SWEEP = """\
scenario: em5
design: cross
runs: 300
vary:
  excitation.duration: [2.0]
  excitation.spectral_class: [EM1, EM5]
  plant.driver_mass: {normal: [60, 9], low: 40, high: 95}
"""
SEATSIM = [sys.executable, "-m", "seatsim"]
HEADROOM = 1.1
"""Share of the time of an undisturbed sweep in which kills fall: some come after the end."""


def main() -> None:
    """Kill, resume, compare; exit with 1 where anything differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kills", nargs="?", type=int, default=30)
    parser.add_argument("--victim", choices=("command", "worker", "scheduler"), default="command")
    parser.add_argument("--seed", type=int, default=0, help="draws the moments")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "sweep.yaml"
        file.write_text(SWEEP, encoding="utf-8")
        with Cluster(options.victim) as cluster:
            run_sweep(file, folder / "warm", cluster)
            process = start(file, folder / "whole", cluster)
            await_manifest(folder / "whole")
            since = time.monotonic()
            process.wait()
            lasts = time.monotonic() - since
        expected = read_bytes(folder / "whole")
        wrong = 0
        for number in range(options.kills):
            moment = rng.uniform(0, HEADROOM * lasts)
            kept, same = kill_once(file, folder / "killed", options.victim, moment, expected)
            wrong += not same
            print(f"{number + 1:3}: {options.victim} killed after {moment:5.2f} s with {kept:4} parts on disk,"
                  f" resumed: {'same' if same else 'DIFFERENT'}", flush=True)  # fmt: skip
    print(f"{options.kills} kills over {lasts:.1f} s: {options.kills - wrong} same, {wrong} different")
    sys.exit(wrong > 0)


class Cluster:
    """A scheduler with two workers on this machine; for kills of the command alone, none."""

    def __init__(self, victim: str) -> None:
        self.wanted = victim != "command"
        self.processes: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Cluster:
        if self.wanted:
            port = random.randrange(20000, 60000)
            self.address = f"tcp://127.0.0.1:{port}"
            self._start("dask_scheduler", "--port", str(port), "--no-dashboard")
            for _ in range(2):
                self._start("dask_worker", self.address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
        return self

    def __exit__(self, *error: object) -> None:
        for process in self.processes:
            process.kill()
            process.wait()

    @property
    def options(self) -> list[str]:
        """Options of the command that use the cluster."""
        return ["--engine", "dask", "--address", self.address] if self.wanted else ["--jobs", "2"]

    def kill(self, victim: str) -> None:
        """Kill the scheduler or the last worker."""
        self.processes[0 if victim == "scheduler" else -1].kill()

    def _start(self, module: str, *options: str) -> None:
        command = [sys.executable, "-m", f"distributed.cli.{module}", *options]
        silent = subprocess.DEVNULL
        self.processes.append(subprocess.Popen(command, stdout=silent, stderr=silent))


def run_sweep(file: Path, out: Path, cluster: Cluster) -> int:
    """Carry out or resume a sweep to its end; return the exit status."""
    return start(file, out, cluster).wait()


def start(file: Path, out: Path, cluster: Cluster) -> subprocess.Popen[bytes]:
    """Start a sweep."""
    command = [*SEATSIM, "sweep", str(file), "--out", str(out), "--resume", *cluster.options]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def await_manifest(out: Path) -> None:
    """Wait until the runs of a sweep begin: what comes before are imports."""
    while not (out / "manifest.json").exists():
        time.sleep(0.005)


def kill_once(file: Path, out: Path, victim: str, moment: float, expected: dict[str, bytes]) -> tuple[int, bool]:
    """Kill after a moment, resume; return how many parts were on the disk, and whether the end is the same."""
    shutil.rmtree(out, ignore_errors=True)
    with Cluster(victim) as cluster:
        process = start(file, out, cluster)
        await_manifest(out)
        time.sleep(moment)
        if victim == "command":
            process.send_signal(signal.SIGKILL)
        else:
            cluster.kill(victim)
        process.wait()
    kept = len(list(out.glob("runs/part-*.parquet")))
    with Cluster(victim) as cluster:
        if run_sweep(file, out, cluster):
            return kept, False
    return kept, read_bytes(out) == expected


def read_bytes(out: Path) -> dict[str, bytes]:
    """Return what a sweep holds by file; its manifest names its folder, which is another one in each sweep."""
    own = f'"folder": "{out.name}"'.encode()
    files = [*out.glob("runs/*.parquet"), out / "manifest.json"]
    return {path.name: path.read_bytes().replace(own, b"") for path in files}


if __name__ == "__main__":
    main()
