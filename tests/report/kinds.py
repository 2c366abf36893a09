"""A report of each kind, of made-up results or of short runs, for tests of what all of them share."""

from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd

from seatsim.characterisation.rows import Row
from seatsim.characterisation.steps import Response
from seatsim.characterisation.summary import Characterisation
from seatsim.characterisation.tabulate import make_sheet
from seatsim.identification.assessment import Agreement, Assessment, Information, ParameterEstimate
from seatsim.metrics.table import METRICS
from seatsim.plots.bench.characterisation import plot_characterisation
from seatsim.plots.bench.identification import plot_predictions
from seatsim.plots.bench.vibration import plot_vibration
from seatsim.plots.runs.draw import plot_result
from seatsim.recordings.bench_tables import BenchRecord
from seatsim.recordings.gap import Gap, GapFigures, ReplayedPair
from seatsim.report.dampers import report_characterisation, report_identification
from seatsim.report.diagnosis import report_diagnosis
from seatsim.report.gap import report_gap
from seatsim.report.rendering import render_report
from seatsim.report.runs import report_runs
from seatsim.report.standards import report_comfort, report_seat_test
from seatsim.report.sweep import report_sweep
from seatsim.scenario.loading import load
from seatsim.simulation.damper_bench import SineTest
from seatsim.simulation.result import Result
from seatsim.simulation.runs import run_one
from seatsim.standards.comfort import comfort
from seatsim.standards.seat_rows import DampingRow, DampingTest, SeatRow, SeatTest
from seatsim.sweeps.parts import SweepRows, count_exceedances
from seatsim.sweeps.sensitivity import analyse_sensitivity

from ..text import beside, parse
from .diagnoses import with_every_run

COMFORT, TRAVEL = "driver_acceleration_weighted", "suspension_displacement_rms"


SEAT = parse(beside(__file__, "seat.yaml"))
"""A rig for short runs, all of which take the same two compiled loops."""


def passive(current):
    """Return settings that drive the coil with a constant current."""
    return {"controller": {"law": "constant", "current": current}}


@cache
def runs():
    """Four runs under one condition; the first is the most comfortable."""
    variants = {"skyhook": {}, "0 A": passive(0.0), "0.1 A": passive(0.1), "0.3 A": passive(0.3)}
    return [run_one(scenario) for scenario in load(SEAT, {"variants": variants})]


@cache
def pictures():
    return plot_result(Result(runs()))


def pair(noise):
    time, errors = 1.0 + np.arange(2000) / 500, noise * np.random.default_rng(0).standard_normal(2000)
    measured, simulated = ({"damper_force": 100 * np.sin(9 * time) + each} for each in (0.0, errors))
    return ReplayedPair(time, measured, simulated, {"damper_force": "N"})


def gap(size, floor=0.02, **runs):
    figures = {"damper_force": size}, GapFigures(floor, {"damper_force": floor})
    return Gap(size, *figures, ("a note",), replayed=runs)


def identification(parts, size=500.0):
    rng = np.random.default_rng(1)
    x = 0.01 * np.sin(np.arange(900) / 30)
    force = size * np.gradient(x) * 500
    record = BenchRecord("sine, 1 A", "sine.csv", 500.0, x, np.gradient(x) * 500, force, np.ones(900), False, None)
    agreement, noise = Agreement(0.99, 0.02, 5.0, 93.2), 0.002 * size * rng.standard_normal((len(parts), 900))
    records = [record._replace(folder=f"rig-{k}") for k in range(len(parts))]
    judged = [Assessment(*each, agreement) for each in zip(records, parts, force + noise, strict=True)]
    known = [ParameterEstimate("c_a", 500.0, 2.0, "N s/m", True), ParameterEstimate("k0", 3.0, 30.0, "N/m", False)]
    return SimpleNamespace(
        model="bouc_wen", bench=SimpleNamespace(damper=None), assessments=judged,
        information=Information(known, 100.0), notes=[], assessed=judged[0].agreement,
        **{part: agreement if part in parts else None for part in ("train", "test")},
    )  # fmt: skip


def characterisation():
    angle = np.linspace(0, 2 * np.pi, 300)
    loop = SineTest(angle, 0.01 * np.sin(angle), 0.06 * np.cos(angle), 300 * np.cos(angle))
    row = Row("a", "a.csv", 3, 0, 0.0, amplitude=0.01, frequency=1.0, peak_rebound=100.0, offset=1e-12, loop=loop)
    rows = [row, row._replace(record="b", current=1.0, peak_rebound=450.0)]
    step = Response("a", 0.0, 1.0, time=np.linspace(0, 0.02, 50), share=np.linspace(0, 1, 50))
    return Characterisation("rig", "data", rows, [step], [], make_sheet(rows, [step]))


@cache
def sweep():
    """Return the rows of a sweep over two numbers and a machine, whose comfort is known."""
    rng = np.random.default_rng(3)
    mass, stiffness = rng.uniform(50, 110, 200), rng.uniform(4000, 5200, 200)
    machine = np.array(["EM1", "EM5"])[rng.permutation(200) % 2]
    comfort = 0.5 + (110 - mass) / 100 + (machine == "EM1") * 0.3 + 1e-4 * (stiffness - 4000) + rng.normal(0, 0.01, 200)
    frame = pd.DataFrame({
        "plant.driver_mass": mass, "plant.suspension_stiffness": stiffness, "excitation.spectral_class": machine,
        COMFORT: comfort, TRAVEL: 0.02 - 0.005 * comfort + rng.normal(0, 4e-4, 200),
        "run": range(200), "state": "done", "reason": "", "seed": 0,
    })  # fmt: skip
    keys = ["plant.driver_mass", "plant.suspension_stiffness", "excitation.spectral_class"]
    limits = {COMFORT: 0.9, TRAVEL: 0.017}
    manifest = {"limits": limits, "counts": {"runs": 200}, "identity": "0", "configuration": {}}
    units = {**dict.fromkeys(frame, ""), COMFORT: METRICS[COMFORT].unit, TRAVEL: "m", keys[0]: "kg", keys[1]: "N/m"}
    return SweepRows(Path("study"), manifest, frame, frame, keys, keys[:2], [COMFORT, TRAVEL], units)


def seat_test():
    rows = [
        SeatRow("seat", name, "light", 55.0, 40.5, seat, 0.7, seat < 0.7, "5.3.2", 1.2, 1.2 * seat, 0.02, True, hits)
        for name, seat, hits in (("EM5", 0.81, 3), ("EM6", 0.6, 0))
    ]
    test = DampingTest(1.7, 2.0, 0.03, (1.0, 1.5, 2.0), (1.2, 1.9, 1.6))
    damping = [DampingRow("seat", "EM5", 2.0, 1.7, 2.0, True, "5.3.3")]
    return SeatTest(tuple(rows), tuple(damping), {"seat": test}, ("a note",))


@cache
def working_day():
    """Return the assessment of two runs that count as one vibration."""
    return comfort("scenarios/data/recording", hours=4.5)


def _report_sweep():
    rows = sweep()
    return report_sweep(rows, analyse_sensitivity(rows), count_exceedances(rows))


def _report_identification():
    found = identification(["train", "test"])
    return report_identification(found, {"loops": plot_predictions(found)}, "seatsim identify data")


def _report_characterisation():
    found = characterisation()
    return report_characterisation(found, plot_characterisation(found), "seatsim characterise data")


@cache
def render(kind):
    """Return the page of a kind."""
    return render_report(KINDS[kind]())


KINDS = {
    "runs": lambda: report_runs(runs(), pictures(), "seatsim compare seat.yaml", "seat"),
    "sweep": _report_sweep,
    "gap": lambda: report_gap("a against b", gap(0.3, a=pair(20.0), b=pair(5.0)), "seatsim gap a b"),
    "diagnosis": lambda: report_diagnosis(with_every_run()),
    "identification": _report_identification,
    "characterisation": _report_characterisation,
    "comfort": lambda: report_comfort(working_day(), plot_vibration(working_day()), "seatsim comfort recording"),
    "seat test": lambda: report_seat_test(seat_test(), "seat", "seatsim seat-test seat"),
}
