"""Records of rigs that nobody here built, and what is known of them (see `real_rigs`).

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
fsae  Passive racing damper on a scotch yoke, 127 mm/s: at 25-29 degC and 50 psi, and under a heat gun at 49-83 degC.
    The motion is counted from the middle of the stroke. No current: the nominal is a Bouc-Wen law at 0 A.

`list_rigs` holds the recordings that are diagnosed as they are (`real_rigs`), with nominals that lack what is known.
`list_carriers` cuts the records into runs of at most 10 s that serve as backgrounds of cases (`measured_carriers`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt, welch

from seatsim.schema.arrays import Array

Table = Mapping[str, Array]
"""Channels of a run, each of shape (N,)."""
Runs = dict[str, Table]
Nominal = dict[str, Any]
"""A nominal scenario as its file has it."""
SETTLED = 0.025
"""s after which a switched voltage counts as steady."""
SCALE = 30.0
"""Factor from the forces and masses of the Quanser rig to those of its recording."""
CUTOFF = 12.0
"""Hz; the Quanser rig's chirp ends at 10 Hz."""
BOUC_WEN = {"k0": 0.0, "x0": 0.0, "f0": 0.0, "n": 2.0}
BENCH_FREE = ("damper.c_a", "damper.c_b", "damper.alpha_a", "damper.alpha_b", "damper.A")
Addition = tuple[str, Mapping[str, float | str], Mapping[str, float]]
"""An effect to be added by hand: name, fixed parameters, free ones with their start."""
FRICTION: Addition = ("suspension.friction", {"presliding": 1e-4}, {"force": 20.0})
GAS_SPRING: Addition = ("damper.gas_spring", {}, {"preload": 50.0, "stiffness": 500.0})
ASYMMETRY: Addition = ("damper.asymmetry", {}, {"viscous": 0.1, "yielding": 0.1})
SATURATION: Addition = ("damper.magnetic_saturation", {}, {"bend": 0.5})
SEAL: Addition = ("damper.seal_friction", {"presliding": 1e-4}, {"force": 10.0})
FADE: Addition = ("damper.thermal_fade", {}, {"viscous": 0.004, "yielding": 0.004})


class RigRecords(NamedTuple):
    """A rig's records, split, with a nominal scenario whose parameters `free` are still a first guess.

    `counted` says of a run's table which rows the nominal is fitted to. `noise` holds the RMS by channel.
    """

    name: str
    kind: str
    sample_rate: float
    known: str
    nominal: Nominal
    free: tuple[str, ...]
    noise: dict[str, float]
    fit: Runs
    runs: Runs
    unseen: Runs
    voltage_gain: float | None = None
    repeats: bool = False
    counted: Callable[[Table], NDArray[np.bool_]] = lambda table: np.full(len(next(iter(table.values()))), True)


def utfsm(data: Path, name: str, currents: Sequence[float]) -> RigRecords:
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
                levels["damper_force"].append(white_noise(segment["force_N"], rate))
                levels["displacement"].append(white_noise(segment["displacement_m"], rate))
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
    noise = {channel: float(np.median(values)) for channel, values in levels.items()}
    about = "damper_bench", 200.0, "static offset of 27-58 N", bench(guess, 130.0)
    return RigRecords(name, *about, BENCH_FREE, noise, *split)


def dyke(data: Path, name: str, rate: float) -> RigRecords:
    """Return the random test of Dyke's prototype: 5 s to fit, three runs of 4 s, the last 30 % unseen."""
    whole = pd.read_csv(data / "dyke_nees_2012_1158" / "ranran_50.csv.gz")
    columns = {"displacement": "displacement_m", "damper_force": "force_N", "command_voltage": "voltage_V"}
    table = {channel: whole[column].to_numpy()[::4] for channel, column in columns.items()}
    noise = {name: white_noise(whole[columns[name]], 3004.8) for name in ("displacement", "damper_force")}
    ends = [round(t * 751.2) for t in (0.0, 5.25, 9.25, 13.25, 17.25, 24.65)]
    pieces: list[Table] = [{c: v[a:b] for c, v in table.items()} for a, b in pairwise(ends)]
    guess = {"c_a": 1500.0, "c_b": 1000.0, "alpha_a": 110.0, "alpha_b": 670.0, "A": 1.8e4, "beta": 9e3, "gamma": 9e3}
    about = "damper_bench", 751.2, "response lag near 8 ms, gas offset of -104 to -140 N", bench(guess, rate)
    split: tuple[Runs, Runs, Runs] = (
        {"first": pieces[0]},
        {f"piece-{k}": pieces[k] for k in (1, 2, 3)},
        {"last": pieces[4]},
    )
    return RigRecords(name, *about, BENCH_FREE, noise, *split, voltage_gain=1.0 / 2.25, counted=_settled)


def quanser(data: Path, name: str, outputs: Sequence[str]) -> RigRecords:
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
        noise = {channel: noise_in_band(place[plate], 2) for channel, plate in plates.items()}
        noise["suspension_displacement"] = noise_in_band(place["unsprung"] - place["road"], 0)
    damper = {"c_a": 0.0, "c_b": 0.0, "alpha_a": 0.0, "alpha_b": 0.0, "A": 2e3, "beta": 1e3, "gamma": 1e3}
    soft = {"suspension_stiffness": 3800.0, "suspension_damping": 20.0}
    soft |= {"cushion_stiffness": 3000.0, "cushion_damping": 60.0}
    plant = {name: SCALE * value for name, value in ({"frame_mass": 1.0, "driver_mass": 2.45} | soft).items()}
    driven = {"controller": {"law": "replay", "current": 0.0}, "excitation": {"kind": "recording"}}
    nominal: Nominal = bench(damper, 130.0) | {"plant": plant} | driven
    about = "seat", 500.0, "guide friction (to the ground); actuator force that does not map", nominal
    split: tuple[Runs, Runs, Runs] = {"repeat-1": tables[0]}, {f"repeat-{k}": tables[k - 1] for k in (2, 3)}, {}
    return RigRecords(name, *about, tuple(f"plant.{key}" for key in soft), noise, *split, repeats=True)


def fsae(data: Path, name: str, file: str, length: float) -> RigRecords:
    """Return a record of the racing damper: six pieces of so many seconds, apart from each other."""
    whole = pd.read_csv(data / "fsae_damper_temperature" / f"{file}.csv.gz")
    rate = 300.03
    middle = 0.5 * float(whole["displacement_m"].min() + whole["displacement_m"].max())
    table = {
        "displacement": whole["displacement_m"].to_numpy() - middle,
        "damper_force": whole["force_N"].to_numpy(),
        "damper_temperature": whole["temperature_C"].to_numpy(),
    }
    noise = {channel: white_noise(table[channel], rate) for channel in table}
    rows = round(length * rate)
    starts = np.linspace(0, len(whole) - rows, 6).astype(int)
    # a record that begins in motion is at rest nowhere: the first second of a run is left out of every gap
    pieces: Runs = {f"piece-{k}": {c: v[a : a + rows] for c, v in table.items()} for k, a in enumerate(starts)}
    fit, runs, unseen = ({name: pieces[name] for name in list(pieces)[k::3]} for k in range(3))
    guess = {"c_a": 1500.0, "c_b": 0.0, "alpha_a": 60.0, "alpha_b": 0.0, "A": 2e3, "beta": 1e3, "gamma": 1e3}
    free = ("damper.c_a", "damper.alpha_a", "damper.A")
    about = "damper_bench", rate, "gas offset, compression-rebound asymmetry, friction", bench(guess, 130.0)
    return RigRecords(name, *about, free, noise, fit, runs, unseen)


def list_rigs(data: Path) -> list[RigRecords]:
    """Return the rigs whose recordings are diagnosed as they are."""
    return [
        utfsm(data, "utfsm", (0.0, 0.25)),
        utfsm(data, "utfsm-all", (0.0, 0.25, 0.5, 0.75, 1.0)),
        dyke(data, "dyke", 1000.0),
        dyke(data, "dyke-130", 130.0),
        fsae(data, "fsae", "t1_3_3_18_18_s5_n100_50psi", 6.0),
        quanser(data, "quanser", ("frame_acceleration", "driver_acceleration", "suspension_displacement")),
        quanser(data, "quanser-travel", ("suspension_displacement",)),
    ]


class CarrierRecords(NamedTuple):
    """Records that serve as a background, and the mechanisms that their nominal may hold beside its free parameters."""

    rig: RigRecords
    mechanisms: tuple[Addition, ...]


def list_carriers(data: Path) -> list[CarrierRecords]:
    """Return the backgrounds of cases, every record among the runs."""
    bench_lags = tuple(_sensor_lag(channel) for channel in ("displacement", "damper_force"))
    outputs = ("frame_acceleration", "driver_acceleration", "suspension_displacement")
    press = [utfsm(data, "utfsm-low", (0.0, 0.25, 0.5)), utfsm(data, "utfsm", (0.0, 0.25, 0.5, 0.75, 1.0))]
    yokes = [
        fsae(data, "fsae", "t1_3_3_18_18_s5_n100_50psi", 6.0),
        fsae(data, "fsae-hot", "t2_3_3_24_24_s5_n100_100psi_with_heat_gun", 6.0),
    ]
    seat = quanser(data, "quanser", outputs)
    return [
        *(CarrierRecords(_all_runs(rig), (GAS_SPRING, ASYMMETRY, SATURATION, *bench_lags)) for rig in press),
        CarrierRecords(_cut(_all_runs(dyke(data, "dyke", 130.0)), 4.1), (GAS_SPRING, ASYMMETRY, *bench_lags)),
        *(CarrierRecords(_all_runs(rig), (GAS_SPRING, ASYMMETRY, SEAL, FADE, *bench_lags)) for rig in yokes),
        CarrierRecords(_thinned(_all_runs(seat), 18.0, 2), (FRICTION, *map(_sensor_lag, outputs))),
    ]


def _sensor_lag(channel: str) -> Addition:
    """Return the lag of a sensor as an effect to be added."""
    return "sensor.lag", {"channel": channel}, {"time": 0.003}


def _all_runs(rig: RigRecords) -> RigRecords:
    return rig._replace(runs={**rig.fit, **rig.runs, **rig.unseen}, fit={}, unseen={})


def _cut(rig: RigRecords, length: float) -> RigRecords:
    """Return records that follow each other, cut into runs of so many seconds, with the rate of the coil free."""
    parts, rows = list(rig.runs.values()), round(length * rig.sample_rate)
    joined = {channel: np.concatenate([part[channel] for part in parts]) for channel in parts[0]}
    count = len(joined["displacement"]) // rows
    runs: Runs = {f"piece-{k}": {c: v[k * rows : (k + 1) * rows] for c, v in joined.items()} for k in range(count)}
    return rig._replace(runs=runs, free=(*rig.free, "actuator.rate"))


def _thinned(rig: RigRecords, length: float, every: int) -> RigRecords:
    rows = round(length * rig.sample_rate)
    runs: Runs = {name: {c: v[:rows:every] for c, v in table.items()} for name, table in rig.runs.items()}
    return rig._replace(runs=runs, sample_rate=rig.sample_rate / every)


def bench(damper: Mapping[str, float], rate: float) -> Nominal:
    """Return a scenario with a simple Bouc-Wen damper."""
    parameters = {**damper, **BOUC_WEN}
    return {
        "damper": {"model": "bouc_wen", "parameters": parameters},
        "actuator": {"rate": rate, "max_current": 1.0},
        "temperature": 20.0,
    }


def white_noise(values: Array | pd.Series[float], rate: float) -> float:
    """Return the RMS of white noise with the median density that is found above 0.7 of the Nyquist frequency."""
    frequency, density = welch(np.asarray(values), rate, nperseg=min(1024, len(values)))
    return float(np.sqrt(np.median(density[frequency > 0.35 * rate]) * rate / 2.0))


def noise_in_band(values: Array, derivative: int) -> float:
    """Return the RMS, below CUTOFF, of a derivative of noise that is as dense as what is found at 100-200 Hz."""
    frequency, density = welch(values, 500.0, nperseg=1024)
    level = float(np.median(density[(frequency > 100.0) & (frequency < 200.0)]))
    power = 2 * derivative + 1
    return float(np.sqrt(level * (2.0 * np.pi) ** (power - 1) * CUTOFF**power / power))


def _slope(values: Array) -> Array:
    return np.gradient(values, 1.0 / 500.0)


def _settled(table: Table) -> NDArray[np.bool_]:
    """Whether the voltage has stood for a while, shape (N,)."""
    rows = np.arange(len(table["command_voltage"]))
    switched = np.abs(np.diff(table["command_voltage"], prepend=table["command_voltage"][0])) > 0.5
    return rows - np.maximum.accumulate(np.where(switched, rows, 0)) > SETTLED * 751.2
