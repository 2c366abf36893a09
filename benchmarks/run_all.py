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

HERE = Path(__file__).resolve().parent
SHARED = HERE.parents[1] / "shared"
QUICK = {
    "loop_peers": "--dampers bingham",
    "sweep_speed": "90",
    "comfort_peers": "",
    "fmu_masters": "--seconds 2",
    "exact_certificates": "{out}/design/design.yaml",
    "complib": "{shared}/complib --only AC1 AC2 NN1 --budget 10 --out {out}/complib.jsonl",
    "law_comparison": "--duration 4 --only EM1 --out {out}/laws",
    "tune_laws": "on_off_skyhook",
    "diagnosis_baselines": "{out}/set --sealed {out}/set.sealed --key {key}",
    "diagnosis_intervals": "--cases 3 --out {out}/intervals",
    "diagnosis_withheld": "--cases-per-effect 1 --effects coil.lag sensor.gain --out {out}/withheld",
    "effect_forms": "--effects coil.delay driver.mass --factors 1 --out {out}/forms",
    "measured_carriers": "--only fsae --cases 2 --methods diagnosis joint-fit --out {out}/carriers",
    "real_rigs": "--only utfsm quanser-travel",
}
"""Arguments of the edition by benchmark."""
NEEDS = {
    "exact_certificates": "synthesise h-infinity --out {out}/design",
    "diagnosis_baselines": "blind make --cases 2 --seed 1 --kinds one --out {out}/set --sealed {out}/set.sealed",
}
"""The command of seatsim that makes what a benchmark reads."""
MEASURED = ("complib", "measured_carriers", "real_rigs")
"""Benchmarks that need measured data."""


def run(name: str, out: Path) -> str:
    """Run the edition of a benchmark, and return how it ended."""
    if name in MEASURED and not SHARED.is_dir():
        return "left out: no measured data"
    key, begun = "", time.perf_counter()
    if name in NEEDS:
        note = out / f"{name}-made.txt"
        command = ["-m", "seatsim", *NEEDS[name].format(out=out).split()]
        made = note.read_text(encoding="utf-8") if note.exists() else call(command, note)
        key = next(iter(re.findall(r"key \(shown once\): (\S+)", made)), "")
    arguments = QUICK[name].format(out=out, shared=SHARED, key=key).split()
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
    parser.add_argument("--only", nargs="+", choices=QUICK, default=list(QUICK), metavar="NAME")
    parser.add_argument("--out", type=Path, default=Path("out/benchmarks"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.only:
        print(f"{name:20} {run(name, options.out.resolve())}", flush=True)


if __name__ == "__main__":
    main()
