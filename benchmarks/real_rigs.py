"""Recordings of rigs that nobody here built, and what the diagnosis says of them: `python benchmarks/real_rigs.py`.

Out of `../shared/data` are written, into `--out` or a folder that is thrown away, never into the repository, folders
`NAME`, `NAME-fit` (the records that the nominal was fitted to) and `NAME-unseen`, all with the same nominal:

utfsm, utfsm-all  MR damper on a press, sines: 0 and 0.25 A, where the offset stands out of the model's own error, and
    all five currents. Raw signals at 200 Hz (of the 1000 Hz files every fifth row, nothing smoothed), from 1.2 s
    before the motion to 8 s after its start or to its end. The current is the constant that was set, a command; no coil
    current was logged. Left out: velocity (a derivative of the displacement), and the force that relaxes after a stop.
dyke  Prototype MR damper, random stroke and switched voltage, every fourth row (751.2 Hz; the filter's corner was 100
    Hz). The current was not recorded: 2.25 V are taken as 1 A, which only names the unit of current. The nominal was
    fitted where the voltage had stood for 25 ms and believes in a driver of 1000 1/s: the standard 130 1/s is already
    the lag of 8 ms that is to be found (`dyke-130`: the same with 130 1/s, where there is no lag to find).
quanser, quanser-travel  Quarter car as a seat: road = floor, middle plate = frame, body = driver, tyre = suspension,
    body's spring = cushion. The chain of masses maps exactly. No force was recorded, so that masses, stiffnesses and
    forces share a free factor; it makes the masses a seat's (x 30), since the contract's scales (100 N) are. Only
    positions were measured: they are low-passed at 12 Hz without phase (the chirp ends at 10 Hz), accelerations are
    their second derivatives; `quanser-travel` compares the travel alone, which is measured. Two things do NOT map, so
    that this is no fair test of whether guide friction is named: a commanded force of up to 1 N (30 N here, in step
    with the road) acts between frame and driver, where the contract's rig has no actuator; and the guides rub against
    the ground, `suspension.friction` against the moving floor. Fitted dashpots absorb most of the friction as well.

A nominal is a plain model without what the data are known to show. That this is in the data is shown without the
diagnosis: the effect is added by hand, fitted with the nominal's parameters inside their tolerance to half of the runs,
and judged on the other half and on the unseen records. `calibrated` has the parameters refitted alone.
"""

from __future__ import annotations

import argparse
import dataclasses
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from rich.console import Console
from rich.table import Table
from ruamel.yaml import YAML
from scipy.optimize import least_squares
from scipy.signal import butter, sosfiltfilt, welch

import seatsim
from seatsim.fields import bounds
from seatsim.files import write_whole
from seatsim.recording import BENCH_CHANNELS, SEAT_CHANNELS, ChannelEntry, Recording, load_recording
from seatsim.registry import find
from seatsim.replay import LEFT_OUT, pooled, single
from seatsim.scenario import Scenario

Runs = dict[str, dict[str, Any]]
DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
TOLERANCE = 0.1
"""Fits to single records scatter by 8-20 % in the leading parameters of the nominals, by more in the others."""
STEP = 1e-3
"""Relative step of the finite differences, above the error of the time integration."""
SETTLED = 0.025
"""s after which a switched voltage counts as steady."""
SCALE = 30.0
"""Factor from the forces and masses of the Quanser rig to those of its recording."""
CUTOFF = 12.0
"""Hz; the Quanser rig's chirp ends at 10 Hz."""
BOUC_WEN = {"k0": 0.0, "x0": 0.0, "f0": 0.0, "n": 2.0}
BENCH_FREE = ("damper.c_a", "damper.c_b", "damper.alpha_a", "damper.alpha_b", "damper.A")
GAS = ("damper.gas_spring", {}, {"preload": 50.0})
BIAS = ("sensor.bias", {"channel": "damper_force"}, {"share": 0.5})
LAG = ("coil.lag", {}, {"time": 0.003})
FRICTION = ("suspension.friction", {"presliding": 1e-4}, {"force": 20.0})

Trial = tuple[tuple[str, dict[str, Any], dict[str, float]], ...]
"""Effects to be added by hand: name, fixed parameters, free ones with their start."""


class Rig(NamedTuple):
    """A rig's records, split, with a nominal scenario whose parameters `free` are still a first guess.

    `counted` says of a run's table which rows the nominal is fitted to. `noise` holds the RMS by channel.
    """

    name: str
    kind: str
    sample_rate: float
    known: str
    nominal: dict[str, Any]
    free: tuple[str, ...]
    noise: dict[str, float]
    fit: Runs
    runs: Runs
    unseen: Runs
    trials: tuple[Trial, ...]
    voltage_gain: float | None = None
    repeats: bool = False
    counted: Callable[[Mapping[str, Any]], Any] = lambda table: np.full(len(next(iter(table.values()))), True)


class Found(NamedTuple):
    """What an effect added by hand is worth: overall gaps on runs that it was not fitted to, and on unseen records."""

    rig: str
    effects: str
    parameters: str
    floor: float
    nominal: float
    calibrated: float
    held_out: float
    unseen: tuple[float, float] | None

    @property
    def shrink(self) -> float:
        """Share by which the gap on the held-out runs is smaller than the nominal's."""
        return 1.0 - self.held_out / self.nominal


def utfsm(data: Path, name: str, currents: Sequence[float]) -> Rig:
    """Return the sines of the damper of UTFSM at some of their currents."""
    records = {
        file: pd.read_csv(data / "utfsm_mr_sine_raw" / f"raw_{file}.csv.gz")
        for file in ("10mm_2Hz", "25mm_0p5Hz", "5mm_3Hz", "5mm_4Hz", "2mm_5Hz", "25mm_0p25Hz")
    }
    levels: dict[str, list[float]] = {"damper_force": [], "displacement": []}

    def part(*files: str) -> Runs:
        found: Runs = {}
        for index, file in enumerate(files):
            turn = -1 if index % 2 else 1  # so that every second run holds every current
            for _, segment in list(records[file].groupby("segment"))[::turn]:
                current = float(segment["current_A"].iloc[0])
                if current not in currents:
                    continue
                time = segment["time_s"].to_numpy()
                rate = 1.0 / float(np.median(np.diff(time)))
                levels["damper_force"].append(white(segment["force_N"], rate))
                levels["displacement"].append(white(segment["displacement_m"], rate))
                rows = segment.iloc[:: round(rate / 200.0)]
                start = int(np.flatnonzero(np.abs(rows["velocity_m_s"]) > 0.003)[0])
                end = int(np.flatnonzero(np.abs(rows["velocity_m_s"]) > 0.003)[-1])
                rows = rows.iloc[max(0, start - 240) : min(end, start + 1600) + 1]
                found[f"{file}-{current:g}A".replace(".", "p")] = {
                    "displacement": rows["displacement_m"].to_numpy(),
                    "damper_force": rows["force_N"].to_numpy(),
                    "current_command": np.full(len(rows), current),
                }
        return found

    split = part("10mm_2Hz"), part("25mm_0p5Hz", "5mm_3Hz"), part("5mm_4Hz", "2mm_5Hz", "25mm_0p25Hz")
    guess = {"c_a": 1100.0, "c_b": 4500.0, "alpha_a": 100.0, "alpha_b": 850.0, "A": 3e4, "beta": 1.5e4, "gamma": 1.5e4}
    return Rig(
        name, "damper_bench", 200.0, "static offset of 27-58 N", bench(guess, 130.0), BENCH_FREE,
        {channel: float(np.median(values)) for channel, values in levels.items()}, *split, ((GAS,), (BIAS,)),
    )  # fmt: skip


def dyke(data: Path, name: str, rate: float) -> Rig:
    """Return the random test of Dyke's prototype: 5 s to fit, three runs of 4 s, the last 30 % unseen."""
    whole = pd.read_csv(data / "dyke_nees_2012_1158" / "ranran_50.csv.gz")
    noise = {"displacement": white(whole["displacement_m"], 3004.8), "damper_force": white(whole["force_N"], 3004.8)}
    table = {
        channel: whole[column].to_numpy()[::4]
        for channel, column in (
            ("displacement", "displacement_m"), ("damper_force", "force_N"), ("command_voltage", "voltage_V"),
        )
    }  # fmt: skip
    ends = [round(t * 751.2) for t in (0.0, 5.25, 9.25, 13.25, 17.25, 24.65)]
    pieces = [{c: v[a:b] for c, v in table.items()} for a, b in pairwise(ends)]
    guess = {"c_a": 1500.0, "c_b": 1000.0, "alpha_a": 110.0, "alpha_b": 670.0, "A": 1.8e4, "beta": 9e3, "gamma": 9e3}
    return Rig(
        name, "damper_bench", 751.2, "response lag near 8 ms, gas offset of -104 to -140 N", bench(guess, rate),
        BENCH_FREE, noise, {"first": pieces[0]}, {f"piece-{k}": pieces[k] for k in (1, 2, 3)}, {"last": pieces[4]},
        ((GAS,), (LAG,), (GAS, LAG)), voltage_gain=1.0 / 2.25, counted=_settled,
    )  # fmt: skip


def quanser(data: Path, name: str, outputs: Sequence[str]) -> Rig:
    """Return the quarter car with these of its outputs: the nominal fitted to the first repeat, the others are runs."""
    plates = {"floor_acceleration": "road", "frame_acceleration": "unsprung", "driver_acceleration": "sprung"}
    band = butter(4, CUTOFF, fs=500.0, output="sos")
    tables, noise = [], {}
    for repeat in (1, 2, 3):
        raw = pd.read_csv(data / "quanser_active_suspension" / f"chirp_A_rep{repeat}.csv.gz")
        place = {plate: raw[f"{plate}_displacement_m"].to_numpy() for plate in plates.values()}
        smooth = {plate: sosfiltfilt(band, values) for plate, values in place.items()}
        table = {channel: _slope(_slope(smooth[plate])) for channel, plate in plates.items()}
        table["suspension_displacement"] = smooth["unsprung"] - smooth["road"]
        tables.append({channel: table[channel] for channel in ("floor_acceleration", *outputs)})
        noise = {channel: in_band(place[plate], 2) for channel, plate in plates.items()}
        noise["suspension_displacement"] = in_band(place["unsprung"] - place["road"], 0)
    damper = {"c_a": 0.0, "c_b": 0.0, "alpha_a": 0.0, "alpha_b": 0.0, "A": 2e3, "beta": 1e3, "gamma": 1e3}
    nominal = bench(damper, 130.0) | {
        "plant": {
            "frame_mass": 1.0 * SCALE, "driver_mass": 2.45 * SCALE, "suspension_stiffness": 3800.0 * SCALE,
            "suspension_damping": 20.0 * SCALE, "cushion_stiffness": 3000.0 * SCALE, "cushion_damping": 60.0 * SCALE,
        },
        "controller": {"law": "replay", "current": 0.0},
        "excitation": {"kind": "recording"},
    }  # fmt: skip
    free = ("suspension_stiffness", "suspension_damping", "cushion_stiffness", "cushion_damping")
    return Rig(
        name, "seat", 500.0, "guide friction (to the ground); actuator force that does not map", nominal,
        tuple(f"plant.{key}" for key in free), noise, {"repeat-1": tables[0]},
        {"repeat-2": tables[1], "repeat-3": tables[2]}, {}, ((FRICTION,),), repeats=True,
    )  # fmt: skip


def bench(damper: Mapping[str, float], rate: float) -> dict[str, Any]:
    """Return a scenario with a simple Bouc-Wen damper."""
    parameters = {**damper, **BOUC_WEN}
    return {
        "damper": {"model": "bouc_wen", "parameters": parameters},
        "actuator": {"rate": rate, "max_current": 1.0},
        "temperature": 20.0,
    }


def white(values: Any, rate: float) -> float:
    """Return the RMS of white noise with the median density that is found above 0.7 of the Nyquist frequency."""
    frequency, density = welch(np.asarray(values), rate, nperseg=min(1024, len(values)))
    return float(np.sqrt(np.median(density[frequency > 0.35 * rate]) * rate / 2.0))


def in_band(values: Any, derivative: int) -> float:
    """Return the RMS, below CUTOFF, of a derivative of noise that is as dense as what is found at 100-200 Hz."""
    frequency, density = welch(values, 500.0, nperseg=1024)
    level = float(np.median(density[(frequency > 100.0) & (frequency < 200.0)]))
    power = 2 * derivative + 1
    return float(np.sqrt(level * (2.0 * np.pi) ** (power - 1) * CUTOFF**power / power))


def _slope(values: Any) -> Any:
    return np.gradient(values, 1.0 / 500.0)


def _settled(table: Mapping[str, Any]) -> Any:
    """Whether the voltage has stood for a while, shape (N,)."""
    rows = np.arange(len(table["command_voltage"]))
    switched = np.abs(np.diff(table["command_voltage"], prepend=table["command_voltage"][0])) > 0.5
    return rows - np.maximum.accumulate(np.where(switched, rows, 0)) > SETTLED * 751.2


def write(rig: Rig, folder: Path) -> Path:
    """Write a rig's three folders with a nominal fitted to the first, and return that of the recording."""
    for part, runs in (("-fit", rig.fit), ("-unseen", rig.unseen), ("", rig.runs)):
        if runs:
            write_part(rig, rig.nominal, runs, folder / f"{rig.name}{part}")
    nominal = fitted(rig, quick(load_recording(folder / f"{rig.name}-fit")))
    for part in ("-fit", "-unseen", ""):
        if (folder / f"{rig.name}{part}").is_dir():
            write_whole(folder / f"{rig.name}{part}" / "nominal.yaml", partial(YAML(typ="safe").dump, nominal))
    return folder / rig.name


def write_part(rig: Rig, nominal: dict[str, Any], runs: Runs, folder: Path) -> None:
    """Write some of a rig's records and a nominal as one recording."""
    units = SEAT_CHANNELS if rig.kind == "seat" else BENCH_CHANNELS
    entries = [{"name": name, "file": f"{name}.csv.gz"} for name in runs]
    for entry in entries[1:] if rig.repeats else ():
        entry["repeat_of"] = entries[0]["name"]
    channels = next(iter(runs.values()))
    noise = {name: {"noise_rms": float(f"{rig.noise[name]:.3g}")} if name in rig.noise else {} for name in channels}
    header = {
        "rig": rig.kind, "sample_rate": rig.sample_rate, "parameter_tolerance": TOLERANCE, "nominal": "nominal.yaml",
        "runs": entries, "channels": {name: {"unit": units[name]} | noise[name] for name in channels},
    }  # fmt: skip
    if rig.voltage_gain is not None:
        header["actuator"] = {"gain": rig.voltage_gain}
    for name, table in runs.items():
        frame = pd.DataFrame({"time": np.arange(len(next(iter(table.values())))) / rig.sample_rate, **table})
        write_whole(folder / f"{name}.csv.gz", partial(frame.to_csv, index=False, float_format="%.9g"))
    for file, content in (("nominal.yaml", nominal), ("recording.yaml", header)):
        write_whole(folder / file, partial(YAML(typ="safe").dump, content))


def quick(recording: Recording) -> Recording:
    """Return the recording with a displacement that is interpolated, not smoothed: a fit replays it often."""
    if "displacement" not in recording.channels:
        return recording
    channels = recording.channels | {"displacement": ChannelEntry("m", 0.0)}
    return dataclasses.replace(recording, channels=channels)


def fitted(rig: Rig, recording: Recording) -> dict[str, Any]:
    """Return the nominal scenario, its free parameters fitted to a recording's counted rows."""
    scenario, skip = single(recording.nominal), round(LEFT_OUT * rig.sample_rate)
    kept = np.concatenate([rig.counted(recording.table(run))[skip:] for run in recording.runs])

    def residual(factors: Any) -> Any:
        return misfit(varied(scenario, rig.free, factors), recording, list(recording.runs), kept)

    ones = np.ones(len(rig.free))
    found = least_squares(residual, ones, bounds=(0.05 * ones, 20.0 * ones), diff_step=STEP).x
    nominal = {key: dict(value) if isinstance(value, dict) else value for key, value in rig.nominal.items()}
    nominal["damper"]["parameters"] = dict(nominal["damper"]["parameters"])
    for name, factor in zip(rig.free, found, strict=True):
        section, _, key = name.partition(".")
        for k in ("A", "beta", "gamma") if key == "A" else (key,):
            values = nominal["damper"]["parameters"] if section == "damper" else nominal[section]
            values[k] = float(f"{values[k] * factor:.5g}")
    return nominal


def misfit(scenario: Scenario, recording: Recording, runs: Sequence[str], kept: Any = slice(None)) -> Any:
    """Return simulated minus measured at the rows kept, in standard deviations of each channel, end to end."""
    measured, simulated = pooled(scenario, recording, runs)
    return np.concatenate([(simulated[name] - measured[name])[kept] / np.std(measured[name]) for name in measured])


def varied(scenario: Scenario, names: Sequence[str], factors: Sequence[float]) -> Scenario:
    """Return the scenario with parameters `section.name` times factors; `damper.A` keeps the yield at |z| = 1."""
    records: dict[str, Any] = {"damper": scenario.damper.record, "plant": scenario.plant}
    for name, factor in zip(names, factors, strict=True):
        section, _, key = name.partition(".")
        for k in ("A", "beta", "gamma") if key == "A" else (key,):
            records[section] = records[section]._replace(**{k: getattr(records[section], k) * float(factor)})
    damper = dataclasses.replace(scenario.damper, record=records["damper"])
    return dataclasses.replace(scenario, damper=damper, plant=records["plant"])


def by_hand(rig: Rig, folder: Path) -> list[Found]:
    """Fit each trial's effects to every second run, parameters inside their tolerance, and judge them on the others."""
    recording, nominal = load_recording(folder), single(folder / "nominal.yaml")
    other = folder.with_name(f"{rig.name}-unseen")
    seen, held = list(recording.runs)[::2], list(recording.runs)[1::2]
    before, first = seatsim.gap(nominal, recording, held), _unseen(nominal, other)
    calibrated, _ = _augmented(rig, nominal, quick(recording), seen, ())
    refitted, found = seatsim.gap(calibrated, recording, held).overall, []
    for trial in rig.trials:
        augmented, shown = _augmented(rig, nominal, quick(recording), seen, trial)
        after, last = seatsim.gap(augmented, recording, held).overall, _unseen(augmented, other)
        effects = " + ".join(effect for effect, _, _ in trial)
        gaps = before.floor["overall"], before.overall, refitted, after
        found.append(Found(rig.name, effects, shown, *gaps, None if first is None or last is None else (first, last)))
    return found


def _unseen(scenario: Scenario, folder: Path) -> float | None:
    return seatsim.gap(scenario, folder).overall if folder.is_dir() else None


def _augmented(
    rig: Rig, nominal: Scenario, recording: Recording, runs: Sequence[str], trial: Trial
) -> tuple[Scenario, str]:
    free = [(find("effect", effect), name, start) for effect, _, starts in trial for name, start in starts.items()]
    count = len(rig.free)

    def scenario(x: Any) -> Scenario:
        values, effects = iter(x[count:]), []
        for effect, fixed, starts in trial:
            chosen = {name: float(start * next(values)) for name, start in starts.items()}
            effects.append(find("effect", effect)(**fixed, **chosen))
        return dataclasses.replace(varied(nominal, rig.free, x[:count]), effects=tuple(effects))

    limits = [(1.0 - TOLERANCE, 1.0 + TOLERANCE)] * count
    limits += [sorted(limit / start for limit in bounds(cls, name)) for cls, name, start in free]
    low, high = zip(*limits, strict=True)
    x = least_squares(
        lambda x: misfit(scenario(x), recording, runs), np.ones(len(limits)), bounds=(low, high), diff_step=STEP
    ).x
    shown = [f"{name} {start * factor:.3g}" for (_, name, start), factor in zip(free, x[count:], strict=True)]
    return scenario(x), ", ".join(shown)


def rigs(data: Path) -> list[Rig]:
    """Return all rigs."""
    return [
        utfsm(data, "utfsm", (0.0, 0.25)),
        utfsm(data, "utfsm-all", (0.0, 0.25, 0.5, 0.75, 1.0)),
        dyke(data, "dyke", 1000.0),
        dyke(data, "dyke-130", 130.0),
        quanser(data, "quanser", ("frame_acceleration", "driver_acceleration", "suspension_displacement")),
        quanser(data, "quanser-travel", ("suspension_displacement",)),
    ]


def nominal_table(folders: Mapping[str, Path], known: Mapping[str, str]) -> Table:
    """Return the gap of each nominal beside its noise floor."""
    table = _table("nominal on the recording's runs", "rig", "runs", "rows", "gap", "noise floor", "known to show")
    for name, folder in folders.items():
        found, recording = seatsim.gap(folder / "nominal.yaml", folder), load_recording(folder)
        rows = sum(len(next(iter(recording.table(run).values()))) for run in recording.runs)
        figures = f"{found.overall:.3f}", f"{found.floor['overall']:.3f}"
        table.add_row(name, str(len(recording.runs)), str(rows), *figures, known[name])
    return table


def evidence_table(found: Sequence[Found]) -> Table:
    """Return what the effects added by hand are worth."""
    columns = ("rig", "effect by hand", "fitted", "floor", "nominal", "calibrated", "with effect", "shrink", "unseen")
    table = _table("effects added by hand, overall gap on held-out runs and unseen records", *columns)
    for f in found:
        unseen = "-" if f.unseen is None else f"{f.unseen[0]:.3f} -> {f.unseen[1]:.3f}"
        gaps = [f"{value:.3f}" for value in (f.floor, f.nominal, f.calibrated, f.held_out)]
        table.add_row(f.rig, f.effects, f.parameters, *gaps, f"{f.shrink:.0%}", unseen)
    return table


def diagnosis_table(folders: Mapping[str, Path], known: Mapping[str, str]) -> Table | str:
    """Return what the diagnosis says beside what is known, or a sentence where there is no diagnosis."""
    try:
        from seatsim import diagnose
    except ImportError:
        return "seatsim.diagnose does not exist yet: no verdicts"
    table = _table("diagnosis", "rig", "verdict", "selected", "where", "shrink", "s", "known to show")
    for name, folder in folders.items():
        start = time.perf_counter()
        try:
            answer = diagnose(folder)
        except seatsim.SeatsimError as error:
            table.add_row(name, "error", str(error), "", "", "", known[name])
            continue
        found = answer if isinstance(answer, Mapping) else answer.as_dict()
        where = ", ".join(f"{entry['block']} {entry['share']:.2f}" for entry in found["where"])
        seconds, shrink = f"{time.perf_counter() - start:.0f}", f"{found['gap']['shrink']:.2f}"
        table.add_row(name, found["verdict"], ", ".join(found["selected"]), where, shrink, seconds, known[name])
    return table


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left")
    for column in columns:
        table.add_column(column)
    return table


def report(data: Path, out: Path, diagnosed: bool) -> None:
    """Write the recordings and print the tables."""
    console = Console(width=180)
    folders, known, found = {}, {}, []
    for rig in rigs(data):
        start = time.perf_counter()
        folders[rig.name], known[rig.name] = write(rig, out), rig.known
        found += by_hand(rig, folders[rig.name])
        values = YAML(typ="safe").load(folders[rig.name] / "nominal.yaml")
        section = values.get("plant", values["damper"]["parameters"])
        console.print(f"{rig.name} ({time.perf_counter() - start:.0f} s): {section}, noise {rig.noise}")
    console.print(nominal_table(folders, known))
    console.print(evidence_table(found))
    console.print(diagnosis_table(folders, known) if diagnosed else "diagnosis left out")


def main() -> None:
    """Read the arguments, write and print."""
    parser = argparse.ArgumentParser(description="recordings of real rigs, and what the diagnosis says of them")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--out", type=Path, help="folder for the recordings; without it they are thrown away")
    parser.add_argument("--no-diagnosis", action="store_true", help="only the recordings and the effects by hand")
    args = parser.parse_args()
    if not args.data.is_dir():
        raise SystemExit(f"{args.data}: the measured data are not there; state their folder with --data")
    with tempfile.TemporaryDirectory() as temporary:
        report(args.data, args.out or Path(temporary), not args.no_diagnosis)


if __name__ == "__main__":
    main()
