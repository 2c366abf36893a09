"""The synthesis on COMPleib against the best values known: `python benchmarks/complib.py DIR --out FILE`.

DIR holds one JSON file a problem (A, B1, B, C1, C, D11, D12, D21) and `best_known.csv`. Every result is a line of FILE,
appended when it is found, and is not made again, so that a run may be stopped and resumed; small problems come first.
Designs with their certificates stand in FILE's folder `designs`. `--only` takes some problems, `--budget` is in s.
Values of gamma below NEGLIGIBLE, best known ones too, count as that.
"""

from __future__ import annotations

import argparse
import csv
import json
import time
from pathlib import Path
from typing import TypedDict

import numpy as np
from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from controllers import Design, GeneralisedPlant, synthesise
from controllers.synthesis.norm import grid_norm
from seatsim.schema.errors import SynthesisError

NEGLIGIBLE = 1e-6
"""AC1, UWV and NN10 have an infimum of zero."""


class ProblemResult(TypedDict, total=False):
    """A line of the file: the problem, then either why there is no design or its figures, then the times in s."""

    name: str
    order: int
    gains: int
    error: str
    gamma: float
    grid: float
    largest_gain: float
    lower_bound: float
    delta: float | None
    wall: float
    processor: float


def load_problem(path: Path) -> GeneralisedPlant:
    """Return a problem of the collection."""
    p = json.loads(path.read_text())
    return GeneralisedPlant(*(p[key] for key in ("A", "B1", "B", "C1", "C", "D11", "D12", "D21")))


def solve(path: Path, budget: float, max_gain: float, designs: Path) -> ProblemResult:
    """Return what a synthesis found, with its time on the wall and on the processor."""
    plant = load_problem(path)
    wall, processor = time.monotonic(), time.process_time()
    found: ProblemResult = {"name": path.stem, "order": plant.order, "gains": int(plant.free.sum())}
    try:
        design = synthesise(plant, max_gain=max_gain, time_budget=budget)
    except SynthesisError as error:
        found["error"] = str(error)
    else:
        design.save(designs / f"{path.stem}.yaml")
        found |= describe(plant, design)
    return found | {"wall": time.monotonic() - wall, "processor": time.process_time() - processor}


def describe(plant: GeneralisedPlant, design: Design) -> ProblemResult:
    """Return the figures of a design; `grid` is its norm from frequencies alone."""
    return {
        "gamma": design.gamma,
        "grid": grid_norm(plant.close(design.gain)).value,
        "largest_gain": float(np.abs(design.gain).max()),
        "lower_bound": design.lower_bound,
        "delta": design.certificate.delta if design.certificate else None,
    }


def tabulate(found: list[ProblemResult], best: dict[str, float]) -> Table:
    """Return one row a problem: gamma, best known, their ratio, certified delta, disagreement of the norms, times."""
    rows = Table(box=None)
    for name in ("problem", "n", "gains", "gamma", "best", "ratio", "delta", "norms", "bound", "s", "cpu s"):
        rows.add_column(name, justify="left" if name == "problem" else "right")
    for f in found:
        if "error" in f:
            rows.add_row(f["name"], str(f["order"]), str(f["gains"]), "none", f"{best.get(f['name'], np.nan):.6g}")
            continue
        gamma, known = f["gamma"], best.get(f["name"], np.nan)
        rows.add_row(
            f["name"],
            str(f["order"]),
            str(f["gains"]),
            f"{gamma:.6g}",
            f"{known:.6g}",
            f"{ratio(gamma, known):.4f}",
            "-" if f["delta"] is None else f"{f['delta']:.0e}",
            f"{abs(f['grid'] / gamma - 1):.0e}" if gamma else "0",
            f"{f['lower_bound']:.4g}",
            f"{f['wall']:.1f}",
            f"{f['processor']:.1f}",
        )
    return rows


def ratio(gamma: float, known: float) -> float:
    """Return gamma over the best known value; 1 where both are negligible."""
    return 1.0 if max(gamma, known) < NEGLIGIBLE else gamma / max(known, NEGLIGIBLE)


def summarise(found: list[ProblemResult], best: dict[str, float]) -> str:
    """Return the counts: within 1 %, better by 0.5 %, certified."""
    ratios = [ratio(f["gamma"], best[f["name"]]) if "gamma" in f else np.inf for f in found if f["name"] in best]
    deltas = [f["delta"] for f in found if "gamma" in f]
    return (
        f"{sum(r <= 1.01 for r in ratios)} of {len(ratios)} within 1 % of the best known value, "
        f"{sum(r < 0.995 for r in ratios)} better by more than 0.5 %; of {len(deltas)} designs "
        f"{sum(d is not None and d <= 1.01e-4 for d in deltas)} are certified at 1e-4, "
        f"{sum(d is not None for d in deltas)} at 0.05"
    )


def main() -> None:
    """Run what is missing, then print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--budget", type=float, default=30.0)
    parser.add_argument("--max-gain", type=float, default=1e6)
    options = parser.parse_args()
    designs = options.out.parent / "designs"
    designs.mkdir(parents=True, exist_ok=True)
    lines = options.out.read_text().splitlines() if options.out.exists() else []
    found = [json.loads(line) for line in lines]
    done = {f["name"] for f in found}
    paths = sorted(options.folder.glob("*.json"), key=lambda path: (path.stat().st_size, path.stem))
    for path in paths:
        if path.stem in done or (options.only and path.stem not in options.only):
            continue
        with threadpool_limits(1):
            result = solve(path, options.budget, options.max_gain, designs)
        with options.out.open("a") as stream:
            stream.write(json.dumps(result) + "\n")
        print(json.dumps(result), flush=True)
        found.append(result)
    with (options.folder / "best_known.csv").open() as stream:
        known = {row["problem"]: row["best_measured_gamma"] for row in csv.DictReader(stream)}
    best = {name: float(value) for name, value in known.items() if value}
    console = Console(width=140)
    console.print(tabulate(sorted(found, key=lambda f: f["name"]), best))
    console.print(summarise(found, best))


if __name__ == "__main__":
    main()
