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
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NotRequired, TypedDict, cast

import numpy as np
from cases import PROCESSES, show_progress
from threadpoolctl import threadpool_limits

import seatsim
from seatsim.blind.make.draw_case import Case, CaseSpecification, draw_case
from seatsim.blind.make.folder import encode_recording, write_folder
from seatsim.blind.make.make import case_name
from seatsim.blind.processes import run_jobs
from seatsim.blind.truth.experiment import Experiment, RunPlan, read_channels, simulate_run
from seatsim.blind.truth.faults import Changes
from seatsim.blind.truth.coil import SCHEDULE
from seatsim.blind.truth.rig import EXCITATION_RATE, SAMPLE_RATE
from seatsim.diagnosis.design.candidate_experiments import CandidateExperiment, excite, list_candidate_experiments
from seatsim.diagnosis.problem import DiagnosisProblem, pose_problem
from seatsim.diagnosis.result import Content, Diagnosis, ProposedExperiment
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


class VerdictSummary(TypedDict):
    """What a verdict names."""

    verdict: str
    selected: list[str]
    indistinguishable: list[list[str]]


class Proposal(TypedDict):
    """The experiment that an ambiguous diagnosis proposes."""

    kind: str
    name: str
    reason: str
    alikeness_now: float
    alikeness_then: float


class Outcome(TypedDict):
    """What came of a case; `second` where an experiment was proposed and carried out."""

    effects: list[str]
    first: VerdictSummary
    experiment: Proposal | None
    second: NotRequired[VerdictSummary]


def try_experiment(out: Path, k: int, effect: str, seed: int) -> None:
    """Write what came of one case."""
    folder, rng = out / case_name(k), np.random.default_rng([seed, k])
    with threadpool_limits(1):
        case = draw_case(CaseSpecification("one", (effect,), WITHOUT[effect]), rng)
        record(case, folder, rng)
        first = seatsim.diagnose(folder)
        proposed = first.experiment
        outcome: Outcome = {
            "effects": case.label()["effects"], "first": summarise(first),
            "experiment": None if proposed is None else describe_proposal(proposed),
        }  # fmt: skip
        if first.verdict == "ambiguous" and proposed is not None and proposed.kind != "none":
            after = folder.with_name(f"{folder.name}-after")
            ruled_out = carry_out(case, first, proposed, folder, after, rng)
            outcome["second"] = summarise(seatsim.diagnose(after, without=ruled_out))
    write_json(out / f"{folder.name}.json", outcome)


def summarise(diagnosis: Diagnosis) -> VerdictSummary:
    """Return what a verdict names."""
    return {
        "verdict": diagnosis.verdict,
        "selected": diagnosis.selected,
        "indistinguishable": diagnosis.indistinguishable,
    }


def describe_proposal(proposed: ProposedExperiment) -> Proposal:
    """Return a proposal without its scenario, under the keys of `diagnosis.json`."""
    return {
        "kind": proposed.kind, "name": proposed.name, "reason": proposed.reason,
        "alikeness_now": proposed.likeness_now, "alikeness_then": proposed.likeness_then,
    }  # fmt: skip


def calibrates(reason: str) -> bool:
    """Whether a proposal, by the reason it gives, has a sensor calibrated, alone or beside another experiment."""
    return "calibrating" in reason


def record(case: Case, folder: Path, rng: np.random.Generator) -> None:
    """Write the runs of a case but the last, which is the unseen one."""
    recorded = range(len(case.experiment.runs) - 1)
    write_folder(folder, encode_recording(case.experiment, case.readings, rng, recorded))


def carry_out(
    case: Case, first: Diagnosis, proposed: ProposedExperiment, folder: Path, after: Path, rng: np.random.Generator
) -> list[str]:
    """Write the recording that holds the proposed experiment into `after`; return the effects that it rules out."""
    changes = sum((fault.changes for fault in case.faults), Changes())
    ruled_out: list[str] = []
    if calibrates(proposed.reason):
        changes = dataclasses.replace(changes, sensor_faults=())
        ruled_out = [name for group in first.indistinguishable for name in group if name.startswith("sensor.")]
    experiment = case.experiment
    if proposed.name != "calibrate_sensor":
        experiment = change_experiment(experiment, find_candidate(folder, proposed))
    motions = [simulate_run(experiment, changes, k) for k in range(len(experiment.runs))]
    readings = [read_channels(experiment, changes, k, motion) for k, motion in enumerate(motions)]
    record(dataclasses.replace(case, experiment=experiment, readings=readings), after, rng)
    return ruled_out


def find_candidate(folder: Path, proposed: ProposedExperiment) -> CandidateExperiment:
    """Return the candidate experiment that is proposed for a recording, with its excitation as it was optimised."""
    with ThreadPoolExecutor() as pool:
        problem = pose_problem(load_recording(folder), pool)
        if proposed.scenario is not None:
            return excite(problem, proposed.name, optimised_factors(problem, proposed.name, proposed.scenario))
        candidates = list_candidate_experiments(problem)
        return next(candidate for candidate in candidates if candidate.name == proposed.name)


def optimised_factors(problem: DiagnosisProblem, name: str, scenario: Content) -> dict[str, float]:
    """Return the factors by which a proposed scenario differs from the excitation of the menu."""
    usual = excite(problem, name).scenario or {}
    factors: dict[str, float] = {}
    for section, keys in usual.items():
        stated = cast("Mapping[str, float]", scenario[section])
        factors |= {key: stated[key] / value for key, value in keys.items() if isinstance(value, float)}
    return factors


def change_experiment(experiment: Experiment, candidate: CandidateExperiment) -> Experiment:
    """Return the true rig and its runs with what a candidate experiment adds: a sensor, a mass, or a run."""
    if candidate.added_sensors:
        return dataclasses.replace(experiment, channels=(*experiment.channels, *candidate.added_sensors))
    if "plant.driver_mass" in candidate.set:
        added = candidate.set["plant.driver_mass"] - experiment.nominal["m"]
        nominal, true = ({**values, "m": values["m"] + added} for values in (experiment.nominal, experiment.true))
        return dataclasses.replace(experiment, nominal=nominal, true=true)
    plan = plan_run(experiment, candidate)
    return dataclasses.replace(experiment, runs=(*experiment.runs[:-1], plan, experiment.runs[-1]))


def plan_run(experiment: Experiment, candidate: CandidateExperiment) -> RunPlan:
    """Return the run in which a candidate experiment shakes the true rig."""
    floor, command = candidate.floor, candidate.floor.command
    assert command is not None
    time = np.arange(len(floor.acceleration)) * floor.step
    ground = np.interp(np.arange(0.0, time[-1], 1.0 / EXCITATION_RATE), time, floor.acceleration)
    schedule = np.interp(np.arange(0.0, time[-1], 1.0 / SAMPLE_RATE), time, command)
    temperature = WARM if candidate.name == "warm_up" else experiment.runs[0].temperature
    return RunPlan("run-x", ground, np.array([SCHEDULE, 0.0, 0.0, 0.0, 0.0, 0.0]), schedule, temperature)


def is_separated(outcome: Outcome) -> bool:
    """Tell whether the second verdict names the effect alone; a sensor that was calibrated leaves nothing to name."""
    second, sensor = outcome["second"], outcome["effects"][0].startswith("sensor.")
    assert outcome["experiment"]
    if calibrates(outcome["experiment"]["reason"]) and sensor:
        return second["verdict"] == "none"
    return second["verdict"] == "known" and second["selected"] == outcome["effects"]


def table(results: Sequence[Outcome]) -> list[str]:
    """Return the lines of a markdown table, an effect each, and all."""
    headings = "effect", "cases", "ambiguous", "the effect among the named", "experiment proposed", "separated", "by"
    lines = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    for effect in [*sorted({outcome["effects"][0] for outcome in results}), "**all**"]:
        own = [outcome for outcome in results if effect in (outcome["effects"][0], "**all**")]
        lines.append(f"| {' | '.join(map(str, (effect, *_list_cells(own))))} |")
    return lines


def _list_cells(results: Sequence[Outcome]) -> list[str]:
    """Return the cells of a row but the first."""
    ambiguous = [outcome for outcome in results if outcome["first"]["verdict"] == "ambiguous"]
    among = [o for o in ambiguous if any(o["effects"][0] in group for group in o["first"]["indistinguishable"])]
    tried = [outcome for outcome in ambiguous if "second" in outcome]
    names = ", ".join(sorted({outcome["experiment"]["name"] for outcome in tried if outcome["experiment"]}))
    shares = [f"{len(some)}/{len(ambiguous)}" for some in (among, tried)]
    separated = f"{sum(map(is_separated, tried))}/{len(tried)}"
    return [str(len(results)), str(len(ambiguous)), *shares, separated, names or "-"]


def load_outcome(file: Path) -> Outcome:
    """Return what came of a case, as `try_experiment` wrote it."""
    return cast(Outcome, json.loads(file.read_text(encoding="utf-8")))


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
    wanted = [(k, effects[k % len(effects)]) for k in range(options.cases_per_effect * len(effects))]
    wanted = [(k, effect) for k, effect in wanted if effect in options.effects]
    files = {k: options.out / f"{case_name(k)}.json" for k, _ in wanted}
    jobs = [(options.out, k, effect, options.seed) for k, effect in wanted if not files[k].exists()]
    run_jobs(try_experiment, jobs, PROCESSES, show_progress)
    print("\n".join(table([load_outcome(file) for file in files.values()])))


if __name__ == "__main__":
    main()
