"""Sealed cases on records of real rigs, and what finds the effect: `python benchmarks/measured_carriers.py --out DIR`.

Out of `../shared/data` are written carriers with their best nominals (`carrier_nominals`), and on each of them cases of
`seatsim blind make --carrier`: an effect put into the measured signals (`cases/NAME`, with its sealed labels and key in
`cases/NAME.sealed` and `.key`). In `cases/NAME-lacking` the nominal lacks one mechanism of its rig beside that, as a
damper's gas spring, which then is at work too. They are diagnosed by seatsim and, where `--methods` names them, by the
baselines (`diagnosis_baselines`) and a joint fit (`joint_fit`). A call broken off goes on where it stopped. Counted
are, by carrier and by effect:

first   the effect is the likeliest cause (under whatever verdict but `none`)
pair    a group of two indistinguishable effects holds it
wrong   neither, and an effect is selected
missed  neither, and none is selected
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from itertools import cycle
from pathlib import Path

import numpy as np
import pandas as pd
from carrier_nominals import DATA, read_gap, require_data, write_carrier
from cases import Diagnoser, diagnose_missing, diagnose_without, show_progress
from diagnosis_baselines import BASELINES
from joint_fit import diagnose_by_joint_fit
from rig_records import list_carriers

from seatsim.blind.carrier.make import Ruler, make_on_carrier
from seatsim.blind.carrier.recorded import Content, read_carrier
from seatsim.blind.make.make import encode_yaml
from seatsim.blind.make.materiality import MATERIAL_SHARE
from seatsim.blind.score.score import score_verdicts
from seatsim.blind.score.verdicts import Verdict, is_right, is_wrong_name, read_verdict
from seatsim.blind.sealed import Label, seal, unseal
from seatsim.schema.files import write_bytes

OUTCOMES = ("first", "pair", "wrong", "missed")
NOMINAL = "nominal.yaml"
Labels = dict[Path, Label]
"""Of every case, by its folder."""


METHODS: dict[str, Diagnoser] = {"diagnosis": partial(diagnose_without, ()), "joint-fit": diagnose_by_joint_fit}
METHODS |= BASELINES


def make_sets(data: Path, out: Path, only: Sequence[str] | None, cases: int, seed: int, jobs: int) -> Labels:
    """Write carriers and their cases, as far as they are not there, and return the labels."""
    chosen = [records for records in list_carriers(data) if not only or records.rig.name in only]
    carriers = [write_carrier(records, out / "carriers") for records in chosen]
    sets = [(carrier, lacking) for carrier in carriers for lacking in (False, True)]
    labels: Labels = {}
    for index, (carrier, lacking) in enumerate(sets):
        mechanisms = list_mechanisms(carrier) if lacking else []
        if lacking and not mechanisms:
            continue
        folder = out / "cases" / (carrier.name + "-lacking" * lacking)
        sealed, note = (folder.with_name(f"{folder.name}.{end}") for end in ("sealed", "key"))
        if not note.is_file():
            key = make_on_carrier(carrier, cases, seed + index, folder, sealed, show_progress, jobs)
            if lacking:
                take_out(mechanisms, folder, sealed, key)
            note.write_text(key)
        opened = unseal(sealed, note.read_text(), folder)
        labels |= {folder / name: label for name, label in opened.labels.items()}
    return labels


def list_mechanisms(folder: Path) -> list[str]:
    """Return the effects of a carrier's nominal, but errors of sensors, that move its channels by a material size."""
    carrier = read_carrier(folder)
    ruler, names = Ruler(carrier), {str(entry["effect"]) for entry in list_effects(carrier.nominal)}
    found = sorted(name for name in names if not name.startswith("sensor."))
    return [n for n in found if ruler.size(carrier._replace(nominal=leave_out(carrier.nominal, n))) > MATERIAL_SHARE]


def leave_out(nominal: Content, effect: str) -> Content:
    """Return a nominal without an effect."""
    return {**nominal, "effects": [entry for entry in list_effects(nominal) if entry["effect"] != effect]}


def list_effects(nominal: Content) -> list[Content]:
    """Return the effects of a nominal."""
    effects = nominal.get("effects")
    return effects if isinstance(effects, list) else []


def take_out(mechanisms: Sequence[str], folder: Path, sealed: Path, key: str) -> None:
    """Take mechanisms from the nominals of the cases of a set, one of each in turns, and seal that with the labels."""
    content = unseal(sealed, key, folder)
    for (case, label), effect in zip(content.labels.items(), cycle(mechanisms)):
        nominal = encode_yaml(leave_out(read_carrier(folder / case).nominal, effect))
        write_bytes(folder / case / NOMINAL, nominal)
        if case in content.unseen:
            content.unseen[case][NOMINAL] = nominal
        label["kind"], label["effects"] = "carried", sorted({effect, *label["effects"]})
        label["blocks"] = sorted({name.partition(".")[0] for name in label["effects"]})
    seal(sealed, folder, key, content)


def outcome(label: Label, verdict: Verdict) -> str:
    """Return what came out of a case: one of OUTCOMES."""
    if is_right(label, verdict):
        return "first" if verdict.causes[0] in label["effects"] else "pair"
    return "wrong" if is_wrong_name(label, verdict) else "missed"


def list_outcomes(labels: Labels, method: str) -> pd.DataFrame:
    """Return carrier, effect and outcome of every case that the method has done, but untouched ones."""
    done = {case: label for case, label in labels.items() if label["kind"] != "untouched" and (case / method).is_dir()}
    found = [
        (case.parent.name, label["effects"][0], outcome(label, read_verdict(case / method / "diagnosis.json")))
        for case, label in sorted(done.items())
    ]
    return pd.DataFrame(found, columns=["carrier", "effect", "outcome"])


def print_results(labels: Labels, carriers: Path) -> None:
    """Print what each method found, and of the diagnosis the sizes and what it names on untouched carriers."""
    for folder in sorted(carriers.iterdir()):
        gap, mechanisms = read_gap(folder)
        print(f"{folder.name}: nominal's gap {gap:.3f}, with {mechanisms or 'no mechanism'}")
    for method in METHODS:
        found = list_outcomes(labels, method)
        for rows in ("carrier", "effect") if len(found) else ():
            counts = pd.crosstab(found[rows], found["outcome"], margins=True, margins_name="all")
            print(f"\n{method}\n{counts.reindex(columns=[*OUTCOMES, 'all'], fill_value=0).to_string()}")
    named = {str(case): label for case, label in labels.items()}
    verdicts = {name: read_verdict(Path(name) / "diagnosis" / "diagnosis.json") for name in named}
    score = score_verdicts(named, verdicts)
    print(f"untouched carriers, not scored: {score.untouched}")
    ratios = [size.found / size.true for size in score.found_sizes if size.true]
    if ratios:
        low, middle, high = np.quantile(ratios, (0.1, 0.5, 0.9))
        print(f"size found over size put in, {len(ratios)} parameters: {middle:.2f} ({low:.2f} to {high:.2f})")


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
    labels = make_sets(require_data(args.data), args.out, args.only, args.cases, args.seed, args.jobs)
    wanted = [(case / name, METHODS[name]) for name in args.methods for case in labels]
    diagnose_missing(wanted, args.jobs)
    print_results(labels, args.out / "carriers")


if __name__ == "__main__":
    main()
