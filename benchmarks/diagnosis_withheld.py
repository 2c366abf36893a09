"""Effects withheld both ways: `python benchmarks/diagnosis_withheld.py --out DIR`.

For every effect of the library fresh cases are made with it alone, with the makers of the blind sets, in `DIR/case-*`,
the labels in `DIR/labels`. Each is diagnosed twice: with the whole library, by which the effect must be named, into
`CASE/diagnosis`, and by a library without it, which must refuse it as `unknown`, into `CASE/withheld`. What is there is
skipped; more cases per effect may be asked for later.

Which effects could stand for the withheld one is said without the recording's outputs: the rig with the true effect, as
fitted, is simulated without noise, and each other effect is fitted to that replicate with the parameters inside their
tolerance. An effect counts as imitable where one other explains IMITATED of it in at least half of its cases.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple, cast

import pandas as pd
from cases import PROCESSES, diagnose_missing, diagnose_without, show_progress
from threadpoolctl import threadpool_limits

from seatsim.blind.make.cases import CaseSpecification
from seatsim.blind.make.make import case_name, draw_files, make_case
from seatsim.blind.score.verdicts import Verdict, is_right, read_verdict
from seatsim.blind.sealed import Label
from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.problem import DiagnosisProblem, pose_problem
from seatsim.diagnosis.select import select_effects
from seatsim.recordings.recording import load_recording
from seatsim.schema.files import write_json
from seatsim.schema.processes import run_jobs
from seatsim.schema.registry import names

IMITATED = 0.88
"""Share of the whitened gap of a replicate from which an effect explains another."""


class WithheldCase(NamedTuple):
    """An effect, what was said of it by the whole library and by one without it, the share that others explain."""

    effect: str
    without: Verdict
    imitators: dict[str, float]
    right: bool


def write_imitators(case: Path, effect: str) -> None:
    """Write what share of the true effect each other could explain."""
    with threadpool_limits(1), ThreadPoolExecutor() as pool:
        shares = find_imitators(pose_problem(load_recording(case), pool), effect)
    write_json(case / "imitated.json", shares)


def find_imitators(problem: DiagnosisProblem, effect: str) -> dict[str, float]:
    """Return what share of the true effect each other could explain; nothing where no simulation shows it."""
    candidates = list_candidates(problem)
    own = [candidate for candidate in candidates if candidate.effect == effect]
    others = [candidate for candidate in candidates if candidate.effect != effect]
    if not own:
        return {}
    objective = Objective(problem, weigh_noise(problem))
    rig = select_effects(objective, own, lambda _: None, 1).sets[1][0].parameters
    measured = {run: problem.simulated(run, rig.deviations, rig.effects) for run in problem.runs}
    replicate = Objective(dataclasses.replace(problem, measured=measured), objective.weights)
    selection = select_effects(replicate, others, lambda _: None, 1)
    whole = selection.calibrated.cost
    return {single.parameters.terms[0].effect: 1.0 - single.cost / whole for single in selection.sets[1]}


def load_label(out: Path, case: str) -> Label:
    """Return the label of a case."""
    # The file was written by `make_case`, so that its form need not be checked.
    return cast(Label, json.loads((out / "labels" / f"{case}.json").read_text(encoding="utf-8")))


def work(out: Path, wanted: Sequence[str], count: int, seed: int) -> list[str]:
    """Make and diagnose what is not there yet of the effects wanted; return the names of the cases."""
    (out / "labels").mkdir(parents=True, exist_ok=True)
    effects = names("effect")
    # A case keeps its number, and with it its draws, however many cases and whichever effects are asked for.
    orders = {k: effects[k % len(effects)] for k in range(count * len(effects)) if effects[k % len(effects)] in wanted}
    there = {path.stem for path in (out / "labels").glob("case-*.json")}
    # Where an effect cannot be made material the makers take another, and the label says so.
    orders_open = {k: CaseSpecification("one", (effect,)) for k, effect in orders.items() if case_name(k) not in there}
    missing = [(draw_files, k, wanted, seed, out, out / "labels") for k, wanted in orders_open.items()]
    run_jobs(make_case, missing, PROCESSES, show_progress)
    cases = [case_name(k) for k in orders]
    open_cases = [case for case in cases if not (out / case / "imitated.json").exists()]
    run_jobs(write_imitators, [(out / case, _effect(out, case)) for case in open_cases], PROCESSES, show_progress)
    whole = [(out / case / "diagnosis", partial(diagnose_without, ())) for case in cases]
    diagnose_missing(
        whole + [(out / case / "withheld", partial(diagnose_without, (_effect(out, case),))) for case in cases]
    )
    return cases


def _effect(out: Path, case: str) -> str:
    """Return the effect that a case has."""
    (effect,) = load_label(out, case)["effects"]
    return effect


def load_case(out: Path, case: str) -> WithheldCase:
    """Return what came of a case."""
    label = load_label(out, case)
    imitators: dict[str, float] = json.loads((out / case / "imitated.json").read_text(encoding="utf-8"))
    whole, without = (read_verdict(out / case / name / "diagnosis.json") for name in ("diagnosis", "withheld"))
    return WithheldCase(label["effects"][0], without, imitators, is_right(label, whole))


def tabulate(cases: Sequence[WithheldCase]) -> pd.DataFrame:
    """Return a row for each effect, and totals over those that no other can imitate and those that another can."""
    rows, alone = [], []
    for effect in sorted({case.effect for case in cases}):
        own = [case for case in cases if case.effect == effect]
        taken = Counter(case.without.named for case in own if case.without.verdict != "unknown")
        imitators = Counter(name for case in own for name, value in case.imitators.items() if value > IMITATED)
        alone += own if all(2 * times < len(own) for times in imitators.values()) else []
        others = ", ".join(f"{name} {times}" for name, times in imitators.most_common())
        mistaken = ", ".join(f"{name} {times}" for name, times in taken.most_common())
        rows.append((effect, *_count(own), mistaken, others))
    imitable = [case for case in cases if case not in alone]
    rows += [(name, *_count(some), "", "") for name, some in (("not imitable", alone), ("imitable", imitable))]
    headings = ["effect", "cases", "named", "refused as unknown", "taken for", "imitable by"]
    return pd.DataFrame(rows, columns=headings)


def _count(cases: Sequence[WithheldCase]) -> tuple[int, int, int]:
    """Return how many cases there are, in how many the effect was named, and in how many its absence was noticed."""
    return len(cases), sum(case.right for case in cases), sum(case.without.verdict == "unknown" for case in cases)


def main() -> None:
    """Read the arguments, make, diagnose, and print the table."""
    parser = argparse.ArgumentParser(description="every effect withheld from the rig's model and from the library")
    parser.add_argument("--cases-per-effect", type=int, default=5)
    parser.add_argument("--effects", nargs="+", choices=names("effect"), default=names("effect"), metavar="EFFECT")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder of the cases; what is there is kept")
    options = parser.parse_args()
    cases = work(options.out, options.effects, options.cases_per_effect, options.seed)
    print(tabulate([load_case(options.out, case) for case in cases]).to_string(index=False))


if __name__ == "__main__":
    main()
