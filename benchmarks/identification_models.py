"""Damper models identified from measured records: `python benchmarks/identification_models.py DIR`.

DIR holds the measured data. Every result stands in `--out` as JSON and is not made again, so that a run may be stopped
and resumed; `--only` takes some groups, `--models` some models.

sines  Every model on the sines at five currents, all but those of 10 mm, 2 Hz and 5 mm, 4 Hz; it predicts these, and an
    earthquake's motion (smoothed by its owner over 0.3 s, mean force removed) that it never saw the like of.
random  The BEST models of the sines with at most MOST parameters on the first 70 % of a record with random motion and a
    switched command; they predict the rest.
heat  Every file of a passive damper apart: the first half fitted, the second predicted, with and without the recorded
    temperature as input. Where it moves by less than 5 K both are one.
joint  The modified Bouc-Wen model on all sines at once: what a fit costs.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, NamedTuple, TypedDict

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from threadpoolctl import threadpool_limits

from seatsim.identification.identify import identify, predict
from seatsim.identification.settings import IdentificationSettings
from seatsim.schema.content import to_content
from seatsim.schema.files import write_json
from seatsim.schema.registry import names

SINES, EARTHQUAKE = "utfsm_mr_sine_raw", "utfsm_mr_earthquake"
RANDOM, HEAT = "dyke_nees_2012_1158/ranran_50.csv.gz", "fsae_damper_temperature"
HELD_OUT = ("*10mm_2Hz*", "*5mm_4Hz*")
AVERAGE = 0.3
"""Seconds over which the earthquake's record was averaged by its owner."""
BEST, MOST = 6, 20
WARMED = ("ellis", "nonsymmetrical_bouc_wen", "modified_bouc_wen", "kwok_tanh", "shear_bouc_wen")
COMPARED = ("original_bingham", "simple_bouc_wen", "modified_bouc_wen")
"""Models that Braz-Cesar and Barros 2012 compare, in the order of rising merit that they found."""
Part = Literal["train", "test", "predicted"]
PARTS: tuple[Part, ...] = ("train", "test", "predicted")
GROUPS = ("sines", "random", "heat", "joint")


class Mean(TypedDict):
    """Mean agreement over records; None where it is not finite."""

    fit_percent: float | None
    rmse: float


class Ranges(TypedDict):
    """The range of temperature in degC that the fitted records hold."""

    temperature: list[float]


class FitResult(TypedDict):
    """What is read again of a result: `fit.json` of `seatsim identify`."""

    train: Mean | None
    test: Mean | None
    predicted: Mean
    parameters: list[object]
    not_identified: list[str]
    coverage: Ranges
    ns_per_step: float
    seconds: float


class FitTask(NamedTuple):
    """A fit: its group, the data's folder or file, the model, what is asked for, and what is predicted besides."""

    group: str
    data: Path
    model: str
    settings: IdentificationSettings
    predicted: Path | None = None

    @property
    def name(self) -> str:
        """Name of the file that keeps the result."""
        cold = "-ignored" if self.settings.ignore_temperature else ""
        return f"{self.group}-{self.data.name.partition('.')[0]}-{self.model}{cold}.json"


def list_sines(data: Path, models: list[str]) -> list[FitTask]:
    """Return the fits of all models to sines."""
    return [
        FitTask("sines", data / SINES, model, IdentificationSettings(HELD_OUT), data / EARTHQUAKE) for model in models
    ]


def list_random(data: Path, models: list[str]) -> list[FitTask]:
    """Return the fits to random motion."""
    return [FitTask("random", data / RANDOM, model, IdentificationSettings(test_fraction=0.3)) for model in models]


def list_temperatures(data: Path, models: list[str]) -> list[FitTask]:
    """Return the fits with and without temperature, of every file apart."""
    files = sorted((data / HEAT).glob("*.csv*"))
    every = [IdentificationSettings(test_fraction=0.5, ignore_temperature=cold) for cold in (False, True)]
    return [FitTask("heat", file, model, settings) for file in files for model in models for settings in every]


def load_or_fit(task: FitTask, out: Path) -> FitResult:
    """Return the result of a task, from its file where that is there."""
    path = out / task.name
    if not path.exists():
        found = identify(task.data, task.model, task.settings)
        found = predict(found, task.predicted, AVERAGE, centred=True) if task.predicted else found
        write_json(path, {**to_content(found), "warm": found.warm, "file": found.to_scenario()})
    result: FitResult = json.loads(path.read_text(encoding="utf-8"))
    return result


def fit_all(tasks: list[FitTask], out: Path) -> Iterator[tuple[FitTask, FitResult]]:
    """Yield every task with its result; one that failed is told and left out."""
    for task in track(tasks, tasks[0].group, disable=not Console().is_terminal):
        try:
            yield task, load_or_fit(task, out)
        except Exception as error:
            print(f"{task.name}: {type(error).__name__}: {error}")


def fit(found: FitResult, part: Part) -> float:
    """Return the mean fit in percent of a part, NaN where there is none."""
    mean = found.get(part)
    return math.nan if mean is None or mean["fit_percent"] is None else mean["fit_percent"]


def tabulate_fits(title: str, results: list[tuple[FitTask, FitResult]], parts: tuple[Part, ...]) -> Table:
    """Return a table of fits, the best prediction of held-out records first."""
    table = Table(title=title, title_justify="left")
    for column in ("model", *(f"{part} fit %" for part in parts), "parameters", "unknown", "ns/step", "s"):
        table.add_column(column, justify="left" if column == "model" else "right")
    for task, found in sorted(results, key=lambda pair: -np.nan_to_num(fit(pair[1], "test"), nan=-1e9)):
        counts = str(len(found["parameters"])), str(len(found["not_identified"]))
        fits = [f"{fit(found, part):.2f}" for part in parts]
        table.add_row(task.model, *fits, *counts, f"{found['ns_per_step']:.0f}", f"{found['seconds']:.0f}")
    return table


def tabulate_order(results: list[tuple[FitTask, FitResult]]) -> Table:
    """Return the errors of the models that a paper ordered."""
    table = Table(title="root mean square error in N; the paper finds the first worst, the last best")
    for column in ("model", "train", "test", "predicted"):
        table.add_column(column)
    known = {task.model: found for task, found in results}
    for model in COMPARED:
        if model in known:
            means = (known[model][part] for part in PARTS)
            table.add_row(model, *(f"{mean['rmse']:.1f}" if mean else "-" for mean in means))
    return table


def tabulate_temperatures(results: list[tuple[FitTask, FitResult]]) -> Table:
    """Return the fits of the second halves with and without temperature."""
    table = Table(title="second half of each file, fit %", title_justify="left")
    for column in ("file", "degC", "model", "train with", "without", "test with", "without", "unknown with"):
        table.add_column(column, justify="left" if column in ("file", "model") else "right")
    pairs: dict[tuple[str, str], dict[bool, FitResult]] = {}
    for task, found in results:
        pairs.setdefault((task.data.name.partition(".")[0], task.model), {})[task.settings.ignore_temperature] = found
    for (file, model), pair in pairs.items():
        if len(pair) == 2:
            low, high = pair[False]["coverage"]["temperature"]
            fits = [f"{fit(pair[cold], part):.2f}" for part in PARTS[:2] for cold in (False, True)]
            table.add_row(file, f"{high - low:.0f}", model, *fits, ", ".join(pair[False]["not_identified"]))
    return table


def report(data: Path, out: Path, groups: list[str], models: list[str]) -> None:
    """Make what is not there and print the tables."""
    console = Console(width=170)
    ranked = models
    if "sines" in groups:
        results = list(fit_all(list_sines(data, models), out))
        console.print(tabulate_fits("sines, and an earthquake predicted from them", results, PARTS))
        console.print(tabulate_order(results))
        few = [(task.model, found) for task, found in results if len(found["parameters"]) <= MOST]
        ranked = [model for model, _ in sorted(few, key=lambda pair: -fit(pair[1], "test"))][:BEST]
    if "random" in groups:
        results = list(fit_all(list_random(data, ranked), out))
        console.print(tabulate_fits("random motion, switched command: the last 30 %", results, ("train", "test")))
    if "heat" in groups:
        chosen = [model for model in WARMED if model in models]
        console.print(tabulate_temperatures(list(fit_all(list_temperatures(data, chosen), out))))
    if "joint" in groups:
        results = list(fit_all([FitTask("joint", data / SINES, "modified_bouc_wen", IdentificationSettings())], out))
        console.print(tabulate_fits("one fit to all sines", results, ("train",)))


def main() -> None:
    """Read the arguments and run."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DIR", help="folder of the measured data")
    parser.add_argument("--out", type=Path, default=Path("out/identification-league"), help="folder of the results")
    parser.add_argument("--only", default=",".join(GROUPS), help="groups, joined by commas")
    parser.add_argument("--models", default="", help="models, joined by commas; all where absent")
    options = parser.parse_args()
    with threadpool_limits(1):
        models = options.models.split(",") if options.models else names("damper")
        report(options.data, options.out, options.only.split(","), models)


if __name__ == "__main__":
    main()
