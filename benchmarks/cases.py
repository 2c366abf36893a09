"""What the benchmarks of the diagnosis share: cases worked through and scored, and a rig fed measured motion."""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.signal import butter, sosfiltfilt
from threadpoolctl import threadpool_limits

from seatsim.blind.labels import KINDS
from seatsim.blind.score.measures import Rate
from seatsim.blind.score.score import score_verdicts
from seatsim.blind.score.verdicts import read_verdict
from seatsim.blind.sealed import unseal
from seatsim.diagnosis.noise import Whitening, even
from seatsim.diagnosis.nuisance import varied
from seatsim.diagnosis.problem import Problem
from seatsim.excitations.base import Floor
from seatsim.rig.plant import Plant
from seatsim.schema.errors import SeatsimError
from seatsim.schema.files import write_json
from seatsim.simulation.augment import read_sensors, undo_reading
from seatsim.simulation.inputs import Forces, SeatInputs

Array = NDArray[np.float64]
Labels = dict[str, dict[str, object]]
"""What was put into each case."""
Content = Mapping[str, object]
"""The content of `diagnosis.json`."""
Method = Callable[[Path], Content]
"""Diagnoses the folder of a case; it must be picklable."""
Job = Callable[[], str]
"""A call that returns what was done; it must be picklable."""


class Label(TypedDict):
    """What was put into a case, as far as it is asked for here."""

    effects: list[str]


PROCESSES = 2
"""Cases that are worked on at once."""
HEAVY = 1e10
"""kg; mass of a frame that no force of the rig moves by more than 1e-6 m in a run."""
CORNER = 40.0
"""Hz below which the measured displacement, of which derivatives are taken, is fed."""
FRAME, TRAVEL = "frame_acceleration", "suspension_displacement"
FORCE, CURRENT = "damper_force", "coil_current"
Ranked = list[tuple[str, float]]
"""Effects with a figure each, best first."""


def rank_by_figure(pairs: Sequence[tuple[str, float]]) -> Ranked:
    """Return the effects by their largest figure."""
    best: dict[str, float] = {}
    for effect, figure in pairs:
        best[effect] = max(figure, best.get(effect, 0.0))
    return sorted(best.items(), key=lambda item: -item[1])


def make_parser(description: str) -> argparse.ArgumentParser:
    """Return a parser of what names a blind set."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of `seatsim blind make`")
    parser.add_argument("--sealed", type=Path, required=True, help="its sealed file")
    parser.add_argument("--key", required=True, help="the key that `blind make` printed")
    parser.add_argument("--cases", type=int, help="only the first so many cases of the folder")
    return parser


def open_labels(options: argparse.Namespace) -> Labels:
    """Return the labels of the cases asked for."""
    labels = unseal(options.sealed, options.key, options.folder).labels
    present = sorted(path.parent.name for path in options.folder.glob("case-*/recording.yaml"))
    return {name: labels[name] for name in present[: options.cases]}


def diagnose_cases(base: Path, cases: Sequence[str], methods: Mapping[str, Method]) -> None:
    """Write `CASE/METHOD/diagnosis.json` of every case and method that has none yet."""
    wanted = [(base / case / name, method) for case in cases for name, method in methods.items()]
    run([partial(write_verdict, out, method) for out, method in wanted if not (out / "diagnosis.json").exists()])


def run(jobs: Sequence[Job]) -> None:
    """Work through jobs in fresh processes, and tell what was done."""
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(job) for job in jobs]
        try:
            for done, future in enumerate(as_completed(futures), 1):
                print(f"{done}/{len(jobs)} {future.result()}", file=sys.stderr, flush=True)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def write_verdict(out: Path, method: Method) -> str:
    """Write what a method says of the case that `out` lies in; one that it refuses stays without, and is wrong."""
    with threadpool_limits(1):
        try:
            write_json(out / "diagnosis.json", method(out.parent))
        except SeatsimError as error:
            write_json(out / "error.json", {"error": str(error)})
    return f"{out.parent.name} {out.name}"


def show(title: str, base: Path, labels: Labels, methods: Sequence[str]) -> None:
    """Print one table of how often each method is right on the cases; a case without a verdict counts as wrong."""
    table = Table(title=f"{title}, {len(labels)} cases", title_justify="left")
    table.add_column("method")
    for heading in ("right", *KINDS, "block first", "false alarms"):
        table.add_column(heading, justify="right")
    for method in methods:
        said = {case: read_verdict(base / case / method / "diagnosis.json") for case in labels}
        missing = sum(verdict.verdict == "missing" for verdict in said.values())
        if missing == len(said):
            continue
        score = score_verdicts(labels, said)
        rates = [score.right, *(score.kinds.get(kind, Rate(0, 0)) for kind in KINDS), score.block, score.false_alarms]
        name = f"{method} ({missing} missing)" if missing else method
        table.add_row(name, *(f"{r.value:.3f} {r.right}/{r.total}" if r.total else "-" for r in rates))
    Console(width=150).print(table)


def uniform_weights(
    problem: Problem, pushes: Mapping[str, Array] | None = None, errors: Mapping[str, Array] | None = None
) -> Whitening:
    """Return weights from stated noise and white errors of the channels, the same at every frequency up to HIGHEST."""
    noise = np.maximum(problem.noise, 1e-3 * problem.spread)[:, None]
    power = {run: noise**2 * values.shape[1] for run, values in problem.measured.items()}
    return even(problem, {run: level + (errors or {}).get(run, 0.0) for run, level in power.items()})


class Clamp:
    """Stands among the effects: a frame so heavy that it moves as it is pushed."""

    def plant(self, plant: Plant) -> Plant:
        """Return the seat with the heavy frame."""
        return plant._replace(frame_mass=HEAVY)


def can_be_fed(problem: Problem) -> bool:
    """Whether the motion of frame and suspension was measured."""
    return {FRAME, TRAVEL} <= set(problem.channels)


def fed(problem: Problem, run: str, u: Array, effects: Sequence[object]) -> Array:
    """Return the compared channels, shape (channels, samples), of a rig whose blocks are all fed measured signals.

    A heavy frame is pushed to move with the measured acceleration a, on a floor that moves with a - x'', so that the
    suspension moves by the measured displacement x. Damper and cushion then answer to measured motion, the damper to
    the measured current, the coil to the command, and the frame's equation, with the sum S of the forces on it and its
    mass ms, says what it should do:

        frame_acceleration = S / ms,

    where the damper's force in S is the measured one if there is a load cell. What a wrong sensor reads is undone
    before it is fed. The recorded floor enters no equation. Over a first second, while what is fed settles, the answer
    goes over from the measured channels.
    """
    step, inputs = 1.0 / problem.recording.header.sample_rate, problem.inputs[run]
    assert isinstance(inputs, SeatInputs)
    floor = inputs.floor
    sensors = [effect for effect in effects if hasattr(effect, "channel")]
    others = [effect for effect in effects if not hasattr(effect, "channel")]
    true = {
        name: undo_reading(sensors, problem.measured[run][k], name, step) for k, name in enumerate(problem.channels)
    }
    motion, position = (_led_in(problem, true[name], floor) for name in (FRAME, TRAVEL))
    position = sosfiltfilt(butter(4, CORNER, fs=1.0 / floor.step, output="sos"), position)
    base = floor._replace(acceleration=motion - np.gradient(np.gradient(position, floor.step), floor.step))

    def answer(base: Floor) -> dict[str, Array]:
        held = inputs._replace(floor=base, forces=Forces(HEAVY * motion))
        return dict(zip(problem.channels, problem.simulated(run, u, [*others, Clamp()], held), strict=True))

    found = answer(base)
    if CURRENT in true and floor.command is not None:
        measured = base._replace(command=None, coil_current=_led_in(problem, true[CURRENT], floor))
        found = answer(measured) | {CURRENT: found[CURRENT]}
    plant = varied(problem.scenario, problem.parameters, u).plant
    assert plant is not None
    parts = round(step / floor.step)
    forces = HEAVY * (found[FRAME] - motion[problem.skip * parts :: parts][: len(found[FRAME])])
    if FORCE in found:
        forces = forces + found[FORCE] - true[FORCE]
    said = np.array(list(read_sensors(sensors, step, found | {FRAME: forces / plant.frame_mass}).values()))
    settled = np.clip(2.0 * np.arange(said.shape[1]) * step - 1.0, 0.0, 1.0)
    fed_back: Array = problem.measured[run] + settled * (said - problem.measured[run])
    return fed_back


def _led_in(problem: Problem, values: Array, floor: Floor) -> Array:
    """Return a course of the rows compared at the steps of a floor, turned about its ends beyond them.

    It is faded in from rest over the second that is not compared.
    """
    rate, skip = problem.recording.header.sample_rate, problem.skip
    rows = round(floor.time[-1] * rate) + 1
    whole = np.pad(values, (skip, rows - skip - len(values)), "reflect", reflect_type="odd")
    whole[:skip] *= np.sin(0.5 * np.pi * np.linspace(-0.1, 1.0, skip).clip(0.0)) ** 2
    return np.interp(floor.time * rate, np.arange(rows), whole)


def replicate(problem: Problem) -> Problem:
    """Return the problem with what the nominal rig would have recorded, with the stated noise of all channels."""
    rng = np.random.default_rng(0)
    level = problem.recording.channels["floor_acceleration"].noise_rms
    measured = {}
    for run in problem.runs:
        inputs = problem.inputs[run]
        assert isinstance(inputs, SeatInputs)
        floor = inputs.floor
        shaken = floor._replace(acceleration=floor.acceleration + level * rng.standard_normal(len(floor.time)))
        true = problem.simulated(run, problem.rest, (), inputs._replace(floor=shaken))
        measured[run] = true + problem.noise[:, None] * rng.standard_normal(true.shape)
    return dataclasses.replace(problem, measured=measured)
