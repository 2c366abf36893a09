"""Whether proposed experiments tell effects apart: `python benchmarks/diagnosis_experiments.py --out DIR`.

Rigs with one effect, by the makers of the blind sets, are recorded without the channels that would tell it from others.
Where the diagnosis is `ambiguous` and proposes an experiment, the true rig is put through that, by the makers too, and
diagnosed again: an excitation, or a run without current, with a locked seat or warm, stands as a further run beside
the recorded ones; a further sensor, or a mass on the driver's place, is there in all of them. A calibrated sensor is
right from then on: it no longer takes part in the rig, nor in the library.

Separated is a case whose second verdict names the effect and no other. Results lie in `DIR/case-*.json`; what is there
is skipped.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NotRequired, TypedDict, cast

import numpy as np
from cases import Label, run
from seatsim.blind.make.case import RunPlan, Setting, drive, read
from seatsim.blind.make.draw import Case, Order, draw_case
from seatsim.blind.truth.commands import SCHEDULE
from seatsim.blind.truth.rig import FINE, RATE
from seatsim.blind.truth.truth import Changes
from threadpoolctl import threadpool_limits

import seatsim
from seatsim.blind.make.folder import recording_files, write_files
from seatsim.diagnosis.design.experiment import Trial, menu
from seatsim.diagnosis.problem import problem
from seatsim.diagnosis.result import Diagnosis
from seatsim.recordings.recording import load_recording
from seatsim.schema.files import write_json

CELL, LOG = ("damper_force",), ("coil_current",)
WITHOUT: Mapping[str, tuple[str, ...]] = {
    "damper.seal_friction": CELL, "suspension.friction": CELL, "damper.gas_spring": CELL, "sensor.bias": CELL,
    "suspension.progressive_spring": CELL, "suspension.end_stop": CELL, "driver.mass": CELL, "sensor.gain": CELL,
    "coil.delay": LOG, "coil.lag": LOG, "coil.asymmetric_lag": LOG, "sensor.clock_skew": LOG, "damper.remanence": LOG,
}  # fmt: skip
"""Effects, and the channels without which others may look like them."""
WARM = 60.0
"""degC of a run for which the damper was warmed up."""


class Said(TypedDict):
    """What a verdict names."""

    verdict: str
    selected: list[str]
    indistinguishable: list[list[str]]


class Found(TypedDict):
    """What came of a case; `second` where an experiment was proposed and carried out."""

    effects: list[str]
    first: Said
    experiment: Mapping[str, str] | None
    second: NotRequired[Said]


def try_experiment(out: Path, k: int, effect: str, seed: int) -> str:
    """Write what came of one case."""
    folder, rng = out / f"case-{k + 1:04d}", np.random.default_rng([seed, k])
    with threadpool_limits(1):
        case = draw_case(Order("one", (effect,), WITHOUT[effect]), rng)
        record(case, folder, rng)
        first = seatsim.diagnose(folder)
        label = cast("Label", case.label())
        found: Found = {"effects": label["effects"], "first": summarise(first), "experiment": first.experiment}
        if first.verdict == "ambiguous" and first.experiment and first.experiment["kind"] != "none":
            after = folder.with_name(f"{folder.name}-after")
            without = carry_out(case, first, folder, after, rng)
            found["second"] = summarise(seatsim.diagnose(after, without=without))
    write_json(out / f"{folder.name}.json", found)
    return folder.name


def summarise(diagnosis: Diagnosis) -> Said:
    """Return what a verdict names."""
    return {
        "verdict": diagnosis.verdict,
        "selected": diagnosis.selected,
        "indistinguishable": diagnosis.indistinguishable,
    }


def record(case: Case, folder: Path, rng: np.random.Generator) -> None:
    """Write the runs of a case but the last, which is the unseen one."""
    write_files(folder, recording_files(case.setting, case.shown, rng, list(range(len(case.setting.runs) - 1))))


def carry_out(case: Case, first: Diagnosis, folder: Path, after: Path, rng: np.random.Generator) -> list[str]:
    """Write the recording that holds the proposed experiment; return the effects that it rules out."""
    assert first.experiment
    changes = Changes()
    for placed in case.placed:
        changes += placed.changes
    setting, ruled_out = case.setting, []
    if "calibrating" in first.experiment["reason"]:
        changes = dataclasses.replace(changes, faults=())
        ruled_out = [name for group in first.indistinguishable for name in group if name.startswith("sensor.")]
    if first.experiment["name"] != "calibrate_sensor":
        trials = menu(problem(load_recording(folder)))
        setting = change_setting(setting, next(trial for trial in trials if trial.name == first.experiment["name"]))
    shown = [read(setting, changes, k, drive(setting, changes, k)) for k in range(len(setting.runs))]
    record(dataclasses.replace(case, setting=setting, shown=shown), after, rng)
    return ruled_out


def change_setting(setting: Setting, trial: Trial) -> Setting:
    """Return the rig and the runs of an entry of the menu."""
    if trial.extra:
        return dataclasses.replace(setting, channels=(*setting.channels, *trial.extra))
    if trial.mass:
        nominal, true = ({**values, "m": values["m"] + trial.mass} for values in (setting.nominal, setting.true))
        return dataclasses.replace(setting, nominal=nominal, true=true)
    floor, command = trial.floor, trial.floor.command
    assert command is not None
    time = np.arange(len(floor.acceleration)) * floor.step
    ground = np.interp(np.arange(0.0, time[-1], 1.0 / FINE), time, floor.acceleration)
    schedule = np.interp(np.arange(0.0, time[-1], 1.0 / RATE), time, command)
    hot = WARM if trial.name == "warm_up" else setting.runs[0].temperature
    plan = RunPlan("run-x", ground, np.array([SCHEDULE, 0.0, 0.0, 0.0, 0.0, 0.0]), schedule, hot)
    return dataclasses.replace(setting, runs=(*setting.runs[:-1], plan, setting.runs[-1]))


def is_separated(found: Found) -> bool:
    """Tell whether the second verdict names the effect alone; a sensor that was calibrated leaves nothing to name."""
    second, sensor = found["second"], found["effects"][0].startswith("sensor.")
    assert found["experiment"]
    if "calibrating" in found["experiment"]["reason"] and sensor:
        return bool(second["verdict"] == "none")
    return bool(second["verdict"] == "known" and second["selected"] == found["effects"])


def table(results: Sequence[Found]) -> list[str]:
    """Return the lines of a markdown table, an effect each, and all."""
    headings = "effect", "cases", "ambiguous", "the effect among the named", "experiment proposed", "separated", "by"
    lines = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    for effect in [*sorted({found["effects"][0] for found in results}), "**all**"]:
        own = [found for found in results if effect in (found["effects"][0], "**all**")]
        open_ = [found for found in own if found["first"]["verdict"] == "ambiguous"]
        held = [found for found in open_ if any(found["effects"][0] in g for g in found["first"]["indistinguishable"])]
        tried = [found for found in open_ if "second" in found]
        names = ", ".join(sorted({found["experiment"]["name"] for found in tried if found["experiment"]}))
        counts = len(own), len(open_), f"{len(held)}/{len(open_)}", f"{len(tried)}/{len(open_)}"
        cells = (effect, *counts, f"{sum(map(is_separated, tried))}/{len(tried)}", names or "-")
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return lines


def main() -> None:
    """Read the arguments, make and diagnose what is not there yet, and print the table."""
    parser = argparse.ArgumentParser(description="whether proposed experiments tell effects apart")
    parser.add_argument("--cases-per-effect", type=int, default=3)
    parser.add_argument("--effects", nargs="+", choices=WITHOUT, default=list(WITHOUT), metavar="EFFECT")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder of the cases; what is there is kept")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    effects = list(WITHOUT)
    jobs = [(k, effects[k % len(effects)]) for k in range(options.cases_per_effect * len(effects))]
    jobs = [(k, effect) for k, effect in jobs if effect in options.effects]
    files = {k: options.out / f"case-{k + 1:04d}.json" for k, _ in jobs}
    run([partial(try_experiment, options.out, k, effect, options.seed) for k, effect in jobs if not files[k].exists()])
    print("\n".join(table([json.loads(file.read_text(encoding="utf-8")) for file in files.values()])))


if __name__ == "__main__":
    main()
