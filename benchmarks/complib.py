"""The synthesis on COMPleib against the best values known: `python benchmarks/complib.py DIR --out FILE`.

DIR holds one JSON file a problem (A, B1, B, C1, C, D11, D12, D21) and `best_known.csv`. Every result is a line of FILE,
appended when it is found, and is not made again, so that a run may be stopped and resumed; small problems come first.
Designs with their certificates stand in FILE's folder `designs`. `--only` takes some problems, `--budget` is in s.
Values of gamma below NEGLIGIBLE, best known ones too, count as that. `--boxes complib_boxes.yaml` takes the problems of
that file, bounds their gains by it, and proves that no gain in the box is better (or, without a design, stabilising):
the proofs stand beside the designs as `NAME.json`, for `exact_global_proofs.py`.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
import pandas as pd
from ruamel.yaml import YAML
from threadpoolctl import threadpool_limits

from controllers import GeneralisedPlant, synthesise
from controllers.synthesis.global_proof import FACTOR, prove_no_better
from controllers.synthesis.norm import grid_norm
from seatsim.schema.errors import SynthesisError

NEGLIGIBLE = 1e-6
"""AC1, UWV and NN10 have an infimum of zero."""


ProblemResult = dict[str, str | float | None]
"""A line of the file: the problem, then either why there is no design or its figures, then the times in s."""
FIGURES = ["order", "gains", "gamma", "lower_bound", "delta", "grid", "boxes", "wall", "processor"]


def solve(path: Path, budget: float, designs: Path, box: float | None) -> ProblemResult:
    """Return what a synthesis found and proved of a box, with its time on the wall and on the processor."""
    problem = json.loads(path.read_text())
    plant = GeneralisedPlant(*(problem[key] for key in ("A", "B1", "B", "C1", "C", "D11", "D12", "D21")))
    wall, processor = time.monotonic(), time.process_time()
    gains, level = int(plant.free.sum()), np.inf
    found: ProblemResult = {"name": path.stem, "order": plant.order, "gains": gains}
    try:
        design = synthesise(plant, max_gain=box or 1e6, time_budget=budget)
    except SynthesisError as error:
        found["error"] = str(error)
    else:
        design.save(designs / f"{path.stem}.yaml")
        level = design.gamma * FACTOR
        found |= {"gamma": design.gamma, "lower_bound": design.lower_bound}
        found["largest_gain"] = float(np.abs(design.gain).max())
        found["grid"] = grid_norm(plant.close(design.gain)).value  # the norm from frequencies alone
        found["delta"] = design.certificate.delta if design.certificate else None
    if box:
        proof = prove_no_better([plant], level, np.full(gains, -box), np.full(gains, box))
        proof.save(designs / f"{path.stem}.json")
        found["boxes"] = proof.boxes if proof.is_proven else None
    return found | {"wall": time.monotonic() - wall, "processor": time.process_time() - processor}


def tabulate(found: list[ProblemResult], best: pd.Series) -> pd.DataFrame:
    """Return a row for each problem: its figures, the best value known, and gamma over that.

    The ratio is 1 where both are negligible, and infinite where there is no design.
    """
    frame = pd.DataFrame(found).set_index("name").reindex(columns=FIGURES).astype(float).sort_index()
    known = best.reindex(frame.index)
    ratio = frame["gamma"] / known.clip(lower=NEGLIGIBLE)
    ratio = ratio.mask(np.maximum(frame["gamma"], known) < NEGLIGIBLE, 1.0).mask(frame["gamma"].isna(), np.inf)
    return frame.assign(best=known, ratio=ratio.where(known.notna()))


def summarise(frame: pd.DataFrame) -> str:
    """Return the counts: within 1 %, better by 0.5 %, certified."""
    ratios, deltas = frame["ratio"].dropna(), frame.loc[frame["gamma"].notna(), "delta"]
    return (
        f"{(ratios <= 1.01).sum()} of {len(ratios)} within 1 % of the best known value, "
        f"{(ratios < 0.995).sum()} better by more than 0.5 %; of {len(deltas)} designs "
        f"{(deltas <= 1.01e-4).sum()} are certified at 1e-4, {deltas.notna().sum()} at 0.05"
    )


def main() -> None:
    """Run what is missing, then print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--budget", type=float, default=30.0)
    parser.add_argument("--boxes", type=Path)
    options = parser.parse_args()
    boxes = YAML(typ="safe").load(options.boxes) if options.boxes else {}
    chosen = options.only or list(boxes)
    designs = options.out.parent / "designs"
    designs.mkdir(parents=True, exist_ok=True)
    options.out.touch()
    found = [json.loads(line) for line in options.out.read_text().splitlines()]
    paths = sorted(options.folder.glob("*.json"), key=lambda path: (path.stat().st_size, path.stem))
    for path in paths:
        if path.stem in {one["name"] for one in found} or (chosen and path.stem not in chosen):
            continue
        with threadpool_limits(1):
            result = solve(path, options.budget, designs, boxes.get(path.stem))
        with options.out.open("a") as stream:
            stream.write(json.dumps(result) + "\n")
        print(json.dumps(result), flush=True)
        found.append(result)
    best = pd.read_csv(options.folder / "best_known.csv", index_col="problem")["best_measured_gamma"]
    frame = tabulate(found, best)
    print(frame.to_string(float_format=lambda value: f"{value:.5g}"))
    print(summarise(frame))


if __name__ == "__main__":
    main()
