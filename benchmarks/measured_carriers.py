"""Sealed cases on records of real rigs, and what finds the effect: `python benchmarks/measured_carriers.py --out DIR`.

Out of `../shared/data` are written carriers with their best nominals (`carrier_nominals`), and on each of them cases of
`seatsim blind make --carrier`: an effect put into the measured signals. They
are diagnosed by seatsim and, where `--methods` names them, by the baselines (`diagnosis_baselines`) and a joint
fit (`joint_fit`). A call broken off goes on where it stopped. Counted are, by carrier and by effect:

first   the effect is the likeliest cause (under whatever verdict but `none`)
pair    a group of two indistinguishable effects holds it
wrong   neither, and an effect is selected
missed  neither, and none is selected
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from carrier_nominals import DATA, read_gap, write_carrier
from cases import Diagnoser, show_progress, write_verdict
from diagnosis_baselines import BASELINES
from joint_fit import diagnose_by_joint_fit
from rich.console import Console
from rich.table import Table
from rig_records import list_carriers

import seatsim
from seatsim.blind.carrier.make import make_on_carrier
from seatsim.blind.labels import Label
from seatsim.blind.processes import run_jobs
from seatsim.blind.score.score import score_verdicts
from seatsim.blind.score.verdicts import Verdict, is_right, is_wrong_name, read_verdict
from seatsim.blind.sealed import unseal
from seatsim.cli.outputs.diagnosis import encode_diagnosis

OUTCOMES = ("first", "pair", "wrong", "missed")
Labels = dict[Path, Label]
"""Of every case, by its folder."""


def diagnose_by_seatsim(case: Path) -> Mapping[str, object]:
    """Return the verdict of seatsim."""
    return encode_diagnosis(seatsim.diagnose(case))


METHODS: dict[str, Diagnoser] = {"diagnosis": diagnose_by_seatsim, "joint-fit": diagnose_by_joint_fit, **BASELINES}


def make_sets(data: Path, out: Path, only: Sequence[str] | None, cases: int, seed: int, jobs: int) -> Labels:
    """Write carriers and their cases, as far as they are not there, and return the labels."""
    chosen = [records for records in list_carriers(data) if not only or records.rig.name in only]
    carriers = [write_carrier(records, out / "carriers") for records in chosen]
    labels: Labels = {}
    for index, carrier in enumerate(carriers):
        folder = out / "cases" / carrier.name
        sealed, note = (out / f"{carrier.name}.{end}" for end in ("sealed", "key"))
        if not note.is_file():
            key = make_on_carrier(carrier, cases, seed + index, folder, sealed, show_progress, jobs)
            note.write_text(key)
        opened = unseal(sealed, note.read_text(), folder)
        labels |= {folder / name: label for name, label in opened.labels.items()}
    return labels


def outcome(label: Label, verdict: Verdict) -> str:
    """Return what came out of a case: one of OUTCOMES."""
    if is_right(label, verdict):
        return "first" if verdict.causes[0] in label["effects"] else "pair"
    return "wrong" if is_wrong_name(label, verdict) else "missed"


def count_outcomes(labels: Labels, method: str, row_of: Callable[[Path, Label], str]) -> dict[str, Counter[str]]:
    """Return how often each outcome came by row, `all` last; cases that the method has not done are left out."""
    rows: dict[str, Counter[str]] = {}
    for case, label in sorted(labels.items()):
        verdict = read_verdict(case / method / "diagnosis.json")
        if label["kind"] == "untouched" or not (case / method).is_dir():
            continue
        for row in (row_of(case, label), "all"):
            rows.setdefault(row, Counter())[outcome(label, verdict)] += 1
    return {row: rows[row] for row in (*sorted(rows.keys() - {"all"}), "all") if row in rows}


def outcome_table(title: str, rows: Mapping[str, Counter[str]]) -> Table:
    """Return outcomes by row."""
    table = Table(title=title, title_justify="left")
    table.add_column("")
    for heading in (*OUTCOMES, "right"):
        table.add_column(heading, justify="right")
    for name, counts in rows.items():
        right, total = counts["first"] + counts["pair"], sum(counts.values())
        table.add_row(name, *(str(counts[key]) for key in OUTCOMES), f"{right}/{total} = {right / total:.0%}")
    return table


def print_results(labels: Labels, carriers: Path, methods: Sequence[str]) -> None:
    """Print what each method found, and of the diagnosis the sizes and what it names on untouched carriers."""
    console = Console(width=150)
    for folder in sorted(carriers.iterdir()):
        gap, mechanisms = read_gap(folder)
        console.print(f"{folder.name}: nominal's gap {gap:.3f}, with {mechanisms or 'no mechanism'}")
    for method in methods:
        by_carrier = count_outcomes(labels, method, lambda case, label: case.parent.name)
        by_effect = count_outcomes(labels, method, lambda case, label: label["effects"][0])
        if by_carrier:
            console.print(outcome_table(f"{method}, by carrier", by_carrier))
            console.print(outcome_table(f"{method}, by effect", by_effect))
    named = {str(case): label for case, label in labels.items()}
    verdicts = {name: read_verdict(Path(name) / "diagnosis" / "diagnosis.json") for name in named}
    score = score_verdicts(named, verdicts)
    console.print(f"untouched carriers, not scored: {score.untouched}")
    ratios = [size.found / size.true for size in score.found_sizes if size.true]
    if ratios:
        low, middle, high = np.quantile(ratios, (0.1, 0.5, 0.9))
        console.print(f"size found over size put in, {len(ratios)} parameters: {middle:.2f} ({low:.2f} to {high:.2f})")


def main() -> None:
    """Make the cases, diagnose what is not diagnosed yet, and print the tables."""
    parser = argparse.ArgumentParser(description="sealed cases on measured recordings")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--out", type=Path, required=True, help="folder for carriers, cases and diagnoses")
    parser.add_argument("--cases", type=int, default=12, help="on each carrier")
    parser.add_argument("--only", nargs="*", metavar="CARRIER", help="names of carriers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="cases that are worked on at once")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=["diagnosis"])
    args = parser.parse_args()
    if not args.data.is_dir():
        raise SystemExit(f"{args.data}: the measured data are not there; state their folder with --data")
    labels = make_sets(args.data, args.out, args.only, args.cases, args.seed, args.jobs)
    wanted = [(case / name, METHODS[name]) for name in args.methods for case in labels]
    todo = [(out, method) for out, method in wanted if not out.is_dir()]
    run_jobs(write_verdict, todo, args.jobs, show_progress)
    print_results(labels, args.out / "carriers", list(METHODS))


if __name__ == "__main__":
    main()
