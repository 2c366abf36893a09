"""Every effect in each of its forms, found again: `python benchmarks/effect_forms.py --out DIR`.

A seat is simulated with one effect in one form, at 0.5, 1 and 2 times a typical size: its runs are those of the nominal
seat under control, replayed with the effect, with noise in every sensor. Each is written as a recording and diagnosed,
and the table says what was found. A verdict is right if it is `known` or `ambiguous` with the effect in `selected` or
in a group, or `none` where nothing material is left: the effect moves no channel by a material size, or the
parameters, refitted within their tolerance, leave no channel a material gap. Typical sizes come first. What is in `DIR`
is not simulated or diagnosed again.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from cases import show_progress, write_verdict
from typical_effects import FORMS, NOISE

import seatsim
from controllers.laws.constant import Replay
from seatsim.blind.score.verdicts import NAMING, Verdict, read_verdict
from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.settings.judging import DecisionSettings
from seatsim.effects.base import EFFECTS
from seatsim.excitations.recording import interpolate_floor
from seatsim.recordings.recording import SEAT_CHANNELS, load_recording
from seatsim.recordings.writer import save_recording
from seatsim.scenario.scenario import Control
from seatsim.schema.content import to_content
from seatsim.schema.fields import field_names
from seatsim.schema.files import write_json, write_text
from seatsim.schema.processes import run_jobs
from seatsim.schema.registry import Record, names
from seatsim.simulation.inputs import SeatInputs
from seatsim.simulation.respond import respond
from seatsim.simulation.result import History, Result

SEAT = Path(__file__).with_name("effect_forms_seat.yaml")
MATERIAL = DecisionSettings().material
FACTORS = (1.0, 0.5, 2.0)
"""Multiples of the typical size, in the order in which they are worked on."""


class FormCase(NamedTuple):
    """An effect in one of its forms, counted from 0, at a multiple of its typical size."""

    effect: str
    form: int
    factor: float

    @property
    def record(self) -> Record:
        """The effect; a limit or a clearance is the smaller, the larger the effect."""
        cls, form = EFFECTS.find(self.effect), FORMS[self.effect][self.form]
        away = EFFECTS.specification_of(cls).off
        sizes = {
            name: value / self.factor if abs(away.get(name, 0.0)) > abs(value) else value * self.factor
            for name, value in form.sizes.items()
        }
        rest: dict[str, Any] = dict.fromkeys(field_names(cls), 0.0) | vars(cls)["_field_defaults"]
        return cls(**{**rest, **form.shape, **sizes})

    @property
    def folder(self) -> str:
        """Name of its folder."""
        return f"{self.effect}-{self.form + 1}-{self.factor:g}"


class FoundForm(NamedTuple):
    """What was said of a case: the verdict, or why the recording was refused.

    `moved` is the largest movement of a channel by the effect, and `left` the largest gap beyond noise of the rig with
    refitted parameters, both in standard deviations.
    """

    case: FormCase
    verdict: Verdict
    moved: float
    left: float
    refused: str

    @property
    def right(self) -> bool:
        """Whether the effect is named, or nothing material is left to be named."""
        if self.verdict.verdict == "none":
            return min(self.moved, self.left) < MATERIAL
        named = {*self.verdict.selected, *(name for group in self.verdict.groups for name in group)}
        return self.verdict.verdict in NAMING and self.case.effect in named


@cache
def run_nominal(seat: Path) -> Result:
    """Return the runs of the nominal seat."""
    return seatsim.run(seat)


def record_case(case: FormCase, out: Path) -> None:
    """Write the recording of a seat with an effect."""
    seat = out / "seat.yaml"
    runs = []
    for run in run_nominal(seat).runs:
        step, recorded = run.history.step, {name: run.history[name] for name in SEAT_CHANNELS}
        inputs = SeatInputs(interpolate_floor(recorded, 2, step / 2), step)
        scenario = dataclasses.replace(run.scenario, control=Control(Replay(), None, None), effects=(case.record,))
        outputs = respond(scenario, inputs)
        runs.append(dataclasses.replace(run, history=History(step, {**run.history.channels, **outputs})))
    save_recording(Result(runs), out / case.folder, list(SEAT_CHANNELS), noise=NOISE)


def measure_movement(folder: Path, effect: Record) -> float:
    """Return the largest movement of a channel beyond its noise by an effect, in the channel's standard deviations."""
    with ThreadPoolExecutor(1) as pool:
        problem = pose_problem(load_recording(folder), pool)
        rigs = problem.residuals([(problem.nominal, (effect,)), (problem.nominal, ())])
    change = np.concatenate([rigs[0][run] - rigs[1][run] for run in problem.runs], axis=1)
    moved = np.sqrt(np.mean(change**2, axis=1))
    return float(np.max(np.where(moved > problem.noise, moved / problem.spread, 0.0)))


def work(case: FormCase, out: Path) -> None:
    """Record and diagnose a case."""
    folder = out / case.folder
    if not (folder / "recording.yaml").exists():
        record_case(case, out)
    if not (folder / "moved.json").exists():
        write_json(folder / "moved.json", measure_movement(folder, case.record))
    write_verdict(folder / "diagnosis", lambda recording: to_content(seatsim.diagnose(recording, budget=math.inf)))


def is_done(case: FormCase, out: Path) -> bool:
    """Whether there is a diagnosis of a case, or why it was refused."""
    return (out / case.folder / "diagnosis").is_dir()


def load_found(case: FormCase, out: Path) -> FoundForm:
    """Return what came of a case."""
    folder, left, refused = out / case.folder, 1.0, ""
    answer = json.loads(next((folder / "diagnosis").glob("*.json")).read_text(encoding="utf-8"))
    if gap := answer.get("gap"):
        pairs = ((after, gap["floor"]["channels"][name]) for name, after in gap["calibrated"]["channels"].items())
        left = max(math.sqrt(max(after**2 - floor**2, 0.0)) for after, floor in pairs)
    else:
        refused = answer["error"]
    moved = json.loads((folder / "moved.json").read_text(encoding="utf-8"))
    return FoundForm(case, read_verdict(folder / "diagnosis" / "diagnosis.json"), moved, left, refused)


def list_cases(effects: Sequence[str], factors: Sequence[float]) -> list[FormCase]:
    """Return the cases of some effects: first forms before further ones, in the order of the factors."""
    wanted = [(factor, k, effect) for effect in effects for k in range(len(FORMS[effect])) for factor in factors]
    return [FormCase(effect, k, f) for f, k, effect in sorted(wanted, key=lambda each: (factors.index(each[0]), each))]


def show_table(found: Sequence[FoundForm]) -> None:
    """Print what was said of each case, and how many verdicts are right."""
    rows = []
    for each in sorted(found, key=lambda each: each.case):
        said = each.verdict.verdict, each.refused or each.verdict.selected, each.verdict.groups
        rows.append((str(each.case.record), each.moved, each.left, *said, each.right))
    headings = ["effect", "moves", "left", "verdict", "selected, or why refused", "groups", "right"]
    print(pd.DataFrame(rows, columns=headings).to_string(index=False, float_format="%.3f"))
    print(f"{sum(each.right for each in found)} of {len(found)} right")


def main() -> None:
    """Read the arguments, simulate and diagnose what is missing, and print the table."""
    parser = argparse.ArgumentParser(description="every effect in each of its forms, simulated and diagnosed")
    parser.add_argument("--effects", nargs="+", choices=names("effect"), default=list(FORMS), metavar="EFFECT")
    parser.add_argument("--factors", nargs="+", type=float, choices=FACTORS, default=FACTORS)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder of the cases; what is there is kept")
    options = parser.parse_args()
    cases = list_cases(options.effects, options.factors)
    write_text(options.out / "seat.yaml", SEAT.read_text(encoding="utf-8"))
    missing = [(case, options.out) for case in cases if not is_done(case, options.out)]
    try:
        run_jobs(work, missing, options.processes, show_progress)
    finally:
        show_table([load_found(case, options.out) for case in cases if is_done(case, options.out)])


if __name__ == "__main__":
    main()
