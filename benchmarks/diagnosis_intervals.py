"""Coverage of the 90 % intervals of parameters: `python benchmarks/diagnosis_intervals.py --cases 45 --out DIR`.

Each case is a rig simulated here with one effect at a drawn size, so that truth has the very parameter that is
estimated, and with what a diagnosis does not know: the plant's parameters lie anywhere in their tolerance, the force of
the damper turns round less sharply than the nominal's, an unmeasured random force pushes the frame, the sensors are
noisy. The effect, taken for known, is fitted as a diagnosis fits it; counted is how often value -+ 1.645 std, and
the stated interval of a diagnosis, holds the truth. `DIR/intervals.csv` has a row for each case.
"""

from __future__ import annotations

import argparse
import dataclasses
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.signal import butter, sosfilt
from threadpoolctl import threadpool_limits
from typical_effects import CHANNELS

from seatsim.diagnosis.candidates import Candidate, list_candidates
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Objective, Parameters
from seatsim.diagnosis.problem import DiagnosisProblem, pose_problem
from seatsim.diagnosis.uncertainty import estimate_standard_deviations
from seatsim.diagnosis.validate import refit_closely
from seatsim.recordings.header import Header, RunEntry
from seatsim.recordings.nuisance import vary
from seatsim.recordings.recording import SEAT_CHANNELS, ChannelEntry, Recording
from seatsim.recordings.replay import recorded_inputs
from seatsim.scenario.loading import single
from seatsim.schema.arrays import Array
from seatsim.schema.fields import replace_fields
from seatsim.schema.files import write_text, write_whole
from seatsim.simulation.inputs import Forces, SeatInputs
from seatsim.simulation.respond import respond

RATE, SECONDS, RUNS, TOLERANCE = 500.0, 12.0, 3, 0.02
NOMINAL = Path(__file__).with_name("diagnosis_intervals_nominal.yaml")
SIZES = {
    "sensor.gain": ("error", 0.03, 0.12), "sensor.bias": ("share", 0.05, 0.3), "sensor.lag": ("time", 0.003, 0.012),
    "coil.delay": ("time", 0.004, 0.016), "coil.lag": ("time", 0.003, 0.01), "coil.current_limit": ("limit", 0.5, 0.8),
    "suspension.friction": ("force", 15.0, 60.0), "driver.mass": ("change", 4.0, 12.0),
    "damper.gas_spring": ("preload", 20.0, 80.0),
}  # fmt: skip
"""The parameter of each effect, with the range that its size is drawn from."""
CHANNEL = dict.fromkeys(("sensor.gain", "sensor.lag"), "driver_acceleration") | {"sensor.bias": "frame_acceleration"}
QUANTILE = 1.645


class IntervalCase(NamedTuple):
    """What was true and what was estimated of a parameter."""

    effect: str
    parameter: str
    true: float
    value: float
    std: float

    @property
    def covered(self) -> bool:
        """Whether the 90 % interval holds the truth."""
        return abs(self.value - self.true) <= QUANTILE * self.std


@dataclass(frozen=True)
class TabledRecording(Recording):
    """A recording whose tables are in memory."""

    tables: dict[str, dict[str, Array]] = field(default_factory=dict)

    def table(self, run: str) -> dict[str, Array]:
        """Return the recorded channels of a run."""
        return dict(self.tables[run])


def draw_inputs(rng: np.random.Generator) -> dict[str, Array]:
    """Return the floor's acceleration, coloured noise up to 15 Hz, and a command that steps."""
    rows = round(RATE * SECONDS)
    shape = butter(2, [0.7, 15.0], "bandpass", fs=RATE, output="sos")
    floor = sosfilt(shape, rng.standard_normal(rows))
    command = np.repeat(rng.uniform(0.0, 1.0, rows // 100 + 1), 100)[:rows]
    return {"floor_acceleration": rng.uniform(0.8, 1.6) * floor / np.std(floor), "current_command": command}


def make_recording(folder: Path, rng: np.random.Generator, effect: str) -> tuple[TabledRecording, Candidate, float]:
    """Return a recording of a rig with an effect, the candidate that has its form, and the true size."""
    parameter, low, high = SIZES[effect]
    size = rng.uniform(low, high)
    write_text(folder / "nominal.yaml", NOMINAL.read_text(encoding="utf-8"))
    header = Header("seat", RATE, "nominal.yaml", TOLERANCE)
    channels = {name: ChannelEntry(SEAT_CHANNELS[name], noise) for name, noise in CHANNELS.items()}
    channels["current_command"] = ChannelEntry("A", 0.0)
    runs = {f"run-{k}": RunEntry(f"run-{k}", f"run-{k}.csv") for k in range(RUNS)}
    blank = TabledRecording(folder, header, runs, channels, None, {run: draw_inputs(rng) for run in runs})
    problem, nominal = pose_blank(blank), single(folder / "nominal.yaml")
    forms = [each for each in list_candidates(problem) if is_form(each, effect, parameter)]
    candidate = min(forms, key=lambda each: len(each.free))
    truth = vary(nominal, problem.parameters, rng.uniform(-1.0, 1.0, len(problem.parameters)))
    damper = replace_fields(truth.damper.record, {"v_ref": rng.uniform(0.008, 0.013)})
    values = [size if name == parameter else start for name, start in zip(candidate.free, candidate.start, strict=True)]
    truth = dataclasses.replace(
        truth, damper=dataclasses.replace(truth.damper, record=damper), effects=(candidate.record(values),)
    )
    force = rng.choice([0.0, 3.0, 6.0])
    tables = {}
    for run, table in blank.tables.items():
        inputs = recorded_inputs(blank, table, 0.001)
        assert isinstance(inputs, SeatInputs)
        pushed = inputs._replace(forces=Forces(force * draw_force(rng, len(inputs.floor.acceleration))))
        outputs = respond(truth, pushed)
        every = {**table, **{name: outputs[name] for name in CHANNELS if name in outputs}}
        tables[run] = {name: values + channels[name].noise_rms * rng.standard_normal(len(values))
                       for name, values in every.items()}  # fmt: skip
    return dataclasses.replace(blank, tables=tables), candidate, size


def draw_force(rng: np.random.Generator, steps: int) -> Array:
    """Return a random force of unit RMS up to 20 Hz."""
    force = sosfilt(butter(1, 20.0, fs=1000.0, output="sos"), rng.standard_normal(steps))
    return np.asarray(force / np.std(force))


def pose_blank(recording: TabledRecording) -> DiagnosisProblem:
    """Return the problem of inputs alone, with outputs made up, which names parameters and candidates."""
    rows = round(RATE * SECONDS)
    made_up = {name: np.random.default_rng(0).standard_normal(rows) for name in CHANNELS}
    tables = {run: {**made_up, **table} for run, table in recording.tables.items()}
    loud = {name: entry._replace(noise_rms=0.0) for name, entry in recording.channels.items()}
    with ThreadPoolExecutor() as pool:
        return pose_problem(dataclasses.replace(recording, channels=loud, tables=tables), pool)


def is_form(candidate: Candidate, effect: str, parameter: str) -> bool:
    """Whether a candidate is a form of an effect in which a parameter is free, on the channel that is meant."""
    channel = candidate.fixed.get("channel")
    return candidate.effect == effect and parameter in candidate.free and channel in (None, CHANNEL.get(effect))


def run_case(folder: Path, seed: int, pool: Executor) -> IntervalCase:
    """Return what was estimated of one case."""
    rng = np.random.default_rng([seed, 19])
    effect = list(SIZES)[seed % len(SIZES)]
    recording, candidate, size = make_recording(folder, rng, effect)
    problem = pose_problem(recording, pool)
    objective = Objective(problem, weigh_noise(problem))
    start = Parameters(problem.nominal).add(candidate, np.asarray(candidate.start))
    fitted = refit_closely(objective, objective.linearise_nuisances(objective.evaluate([start])[0]))
    (term,), (values,) = fitted.parameters.terms, fitted.parameters.values
    index = term.free.index(SIZES[effect][0])
    deviations = estimate_standard_deviations(objective, fitted, objective.linearise_nuisances(fitted))
    std = deviations[len(fitted.parameters.deviations) + index] * term.scale[index]
    return IntervalCase(effect, term.free[index], size, float(values[index]), float(std))


def summarise(frame: pd.DataFrame) -> pd.DataFrame:
    """Return coverage by effect, the last row over all, and medians of std over value and of error over std."""
    frame = frame.assign(share=frame["std"] / frame["value"].abs(), off=(frame["value"] - frame["true"]).abs())
    frame["error"] = frame["off"] / frame["std"]
    figures = {"covered": ("covered", "sum"), "cases": ("covered", "size")}
    figures |= {"std / |value|": ("share", "median"), "|error| / std": ("error", "median")}
    return pd.concat([frame.groupby("effect").agg(**figures), frame.groupby(lambda _: "all").agg(**figures)])


def main() -> None:
    """Make and fit the cases, print the coverage and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=45)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    cases = []
    with ThreadPoolExecutor() as pool, threadpool_limits(1):
        for seed in range(arguments.cases):
            cases.append(run_case(arguments.out, seed, pool))
    frame = pd.DataFrame([case._asdict() | {"covered": case.covered} for case in cases])
    write_whole(arguments.out / "intervals.csv", partial(frame.to_csv, index=False))
    print(summarise(frame).to_string(float_format="%.3f"))


if __name__ == "__main__":
    main()
