"""Effects withheld both ways: `python benchmarks/diagnosis_withheld.py --out DIR`.

For every effect of the library fresh cases are made with it alone, with the makers of the blind sets, in `DIR/case-*`,
the labels in `DIR/labels`. Each is diagnosed twice: with the whole library, by which the effect must be named, into
`CASE/diagnosis`, and by a library without it, which must refuse it as `unknown`, into `CASE/withheld`. What is there is
skipped; more cases per effect may be asked for later.

Which effects could stand for the withheld one is said without the recording's outputs: the rig with the true effect, as
fitted, is simulated without noise, and each other effect is fitted to that twin with the parameters inside their
tolerance. An effect counts as imitable where one other explains IMITATED of it in at least half of its cases.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from cases import Content, Job, Label, run, write_verdict
from threadpoolctl import threadpool_limits

from seatsim.blind.make.draw_case import CaseSpecification
from seatsim.blind.make.make import make_case
from seatsim.blind.score.verdicts import Verdict, is_right, read_verdict
from seatsim.cli.outputs.diagnosis import encode_diagnosis
from seatsim.diagnosis.candidates import candidates
from seatsim.diagnosis.decide import EXPLAINED
from seatsim.diagnosis.design.collinearity import with_member
from seatsim.diagnosis.diagnose import diagnose
from seatsim.diagnosis.fit import Engine, Point
from seatsim.diagnosis.noise import whitening
from seatsim.diagnosis.problem import problem
from seatsim.diagnosis.select import search
from seatsim.recordings.recording import load_recording
from seatsim.schema.files import write_json
from seatsim.schema.registry import names

IMITATED = 1.0 - EXPLAINED
"""Share of the whitened gap of a twin from which an effect explains another."""


class WithheldCase(NamedTuple):
    """An effect, what was said of it by the whole library and by one without it, the share that others explain."""

    effect: str
    without: Verdict
    alike: dict[str, float]
    right: bool


def make(k: int, effect: str, seed: int, out: Path) -> str:
    """Make one case; where the effect cannot be made material the makers take another, and its label says so."""
    make_case(k, CaseSpecification("one", (effect,)), seed, out, out / "labels")
    return f"made {case_name(k)}"


def case_name(k: int) -> str:
    """Return the name that the makers give to a case."""
    return f"case-{k + 1:04d}"


def diagnose_without(without: Sequence[str], case: Path) -> Content:
    """Return the diagnosis of a case by a library without some effects."""
    return encode_diagnosis(diagnose(case, without=without))


def find_imitators(case: Path, effect: str) -> str:
    """Write what share of the true effect each other could explain; nothing where that has no trace to foretell."""
    shares: dict[str, float] = {}
    with threadpool_limits(1):
        posed = problem(load_recording(case))
        offered = candidates(posed)
        others = [candidate for candidate in offered if candidate.effect != effect]
        if len(others) < len(offered):
            engine = Engine(posed, whitening(posed))
            nominal = engine.states([Point(posed.rest)])[0]
            engine.refresh(nominal)
            true = with_member(engine, engine.fitted(nominal), effect, [effect]).point
            measured = {run: posed.simulated(run, true.u, true.effects) for run in posed.runs}
            twin = Engine(dataclasses.replace(posed, measured=measured), engine.white)
            found = search(twin, others, lambda _: None, 1)
            whole = found.calibrated.cost
            shares = {state.point.terms[0].effect: 1.0 - state.cost / whole for state in found.sets[1]}
    write_json(case / "imitated.json", shares)
    return f"{case.name} imitated"


def load_label(out: Path, case: str) -> Label:
    """Return the label of a case."""
    label: Label = json.loads((out / "labels" / f"{case}.json").read_text(encoding="utf-8"))
    return label


def work(out: Path, wanted: Sequence[str], count: int, seed: int) -> list[str]:
    """Make and diagnose what is not there yet of the effects wanted; return the names of the cases."""
    (out / "labels").mkdir(parents=True, exist_ok=True)
    note = out / "seed.json"
    if note.exists() and json.loads(note.read_text(encoding="utf-8")) != seed:
        raise SystemExit(f"{out}: holds cases of another seed; give that, or another --out")
    write_json(note, seed)
    effects = names("effect")
    orders = {k: effects[k % len(effects)] for k in range(count * len(effects)) if effects[k % len(effects)] in wanted}
    there = {path.stem for path in (out / "labels").glob("case-*.json")}
    run([partial(make, k, effect, seed, out) for k, effect in orders.items() if case_name(k) not in there])
    cases = [case_name(k) for k in orders]
    jobs: list[Job] = []
    for case in cases:
        (effect,) = load_label(out, case)["effects"]
        folder = out / case
        jobs += [partial(find_imitators, folder, effect)] if not (folder / "imitated.json").exists() else []
        for name, without in (("diagnosis", ()), ("withheld", (effect,))):
            if not (folder / name / "diagnosis.json").exists():
                jobs.append(partial(write_verdict, folder / name, partial(diagnose_without, without)))
    run(jobs)
    return cases


def load_case(out: Path, case: str) -> WithheldCase:
    """Return what came of a case."""
    label = load_label(out, case)
    alike = json.loads((out / case / "imitated.json").read_text(encoding="utf-8"))
    whole, without = (read_verdict(out / case / name / "diagnosis.json") for name in ("diagnosis", "withheld"))
    return WithheldCase(label["effects"][0], without, alike, is_right(label, whole))


def table(cases: Sequence[WithheldCase]) -> list[str]:
    """Return the lines of a markdown table, an effect each, and totals over those that no other can imitate."""
    headings = "effect", "named", "refused as unknown", "taken for", "imitable by", "most like"
    lines = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    alone: list[WithheldCase] = []
    imitable: list[WithheldCase] = []
    for effect in sorted({case.effect for case in cases}):
        own = [case for case in cases if case.effect == effect]
        taken = Counter(case.without.named for case in own if case.without.verdict != "unknown")
        imitators = Counter(name for case in own for name, value in case.alike.items() if value > IMITATED)
        (imitable if any(2 * times >= len(own) for times in imitators.values()) else alone).extend(own)
        others = ", ".join(f"{name} {times}/{len(own)}" for name, times in imitators.most_common())
        mistaken = ", ".join(f"{name} {times}" for name, times in taken.most_common())
        cells = effect, _named(own), _refused(own), mistaken or "-", others or "-", _nearest(own)
        lines.append(f"| {' | '.join(cells)} |")
    for title, some in (("not imitable", alone), ("imitable", imitable), ("all", list(cases))):
        effects = f"**{title}**, {len({case.effect for case in some})} effects"
        lines.append(f"| {effects} | {_named(some)} | {_refused(some)} | | | |")
    return lines


def _nearest(cases: Sequence[WithheldCase]) -> str:
    """Return the effect with the largest alikeness on average, with that."""
    sums = {name: sum(case.alike.get(name, 0.0) for case in cases) for name in cases[0].alike}
    nearest = max(sums, key=lambda name: sums[name], default=None)
    return f"{nearest} {sums[nearest] / len(cases):.2f}" if nearest else "-"


def _named(cases: Sequence[WithheldCase]) -> str:
    return f"{sum(case.right for case in cases)}/{len(cases)}"


def _refused(cases: Sequence[WithheldCase]) -> str:
    return f"{sum(case.without.verdict == 'unknown' for case in cases)}/{len(cases)}"


def main() -> None:
    """Read the arguments, make, diagnose, and print the table."""
    parser = argparse.ArgumentParser(description="every effect withheld from the rig's model and from the library")
    parser.add_argument("--cases-per-effect", type=int, default=5)
    parser.add_argument("--effects", nargs="+", choices=names("effect"), default=names("effect"), metavar="EFFECT")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder of the cases; what is there is kept")
    options = parser.parse_args()
    cases = work(options.out, options.effects, options.cases_per_effect, options.seed)
    print("\n".join(table([load_case(options.out, case) for case in cases])))


if __name__ == "__main__":
    main()
