"""The consistency residual: how badly the channels of a run fit a simulation, and each other.

With `e(a, b) = rms(a - b) / sqrt(rms(a)^2 + rms(b)^2)` (0 alike, 1 unrelated or of another size, 1.41 opposite) between
0.5 and 8 Hz, the consistency residual of a run is the sum of e^2 over

    each compared channel against the simulation (the coil current at all frequencies),
    x'' against frame acceleration - floor acceleration (a bench: x' against velocity),
    Fd against -(ms zs'' + m zc'' + kf x + cf x'),

where the channels are recorded. In this band a seat and its nominal simulation agree even where the nominal is rough.
Below it drift and bias dominate, above it noise, friction and the cushion.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

import numpy as np

from seatsim.recordings.quality.issue import RunUnderTest, Table
from seatsim.recordings.replay import COMPARED, LEFT_OUT, replay_table
from seatsim.schema.arrays import Array
from seatsim.schema.errors import RunError


def simulate_nominal(run: RunUnderTest, table: Table) -> Table | None:
    """Return the nominal outputs that are compared, driven by a table's inputs; None where there is no solution."""
    try:
        return replay_table(run.nominal, run.recording, table)
    except RunError:
        return None


def consistency_residuals(run: RunUnderTest, table: Table, outputs: Table | None) -> dict[str, float]:
    """Return e^2 of each compared channel (1 where there is no simulation) and of each balance between channels."""
    skip = round(LEFT_OUT * run.rate)
    used = {name: values[skip:] for name, values in table.items()}
    compared = [name for name in COMPARED[run.recording.header.rig] if name in used]
    pairs = {name: (used[name], np.zeros_like(used[name]) if outputs is None else outputs[name]) for name in compared}
    pairs |= _balances(run, used)
    if not pairs:
        return {}
    smooth = dict(zip(pairs, filter_band(run, np.array(list(pairs.values()))), strict=True))
    return {name: unlike(*(pair if name == "coil_current" else smooth[name])) for name, pair in pairs.items()}


def _balances(run: RunUnderTest, used: Table) -> Iterator[tuple[str, tuple[Array, Array]]]:
    """Yield name and both sides of each equation between recorded channels alone."""
    plant = run.nominal.plant
    travel = used.get("suspension_displacement")
    if {"displacement", "velocity"} <= set(used):
        yield "velocity balance", (_slope(run, used["displacement"]), used["velocity"])
    if plant is None or travel is None or "frame_acceleration" not in used:
        return
    frame, speed = used["frame_acceleration"], _slope(run, travel)
    yield "motion balance", (_slope(run, speed), frame - used["floor_acceleration"])
    if {"damper_force", "driver_acceleration"} <= set(used):
        inertia = plant.frame_mass * frame + plant.driver_mass * used["driver_acceleration"]
        spring = plant.suspension_stiffness * travel + plant.suspension_damping * speed
        yield "force balance", (used["damper_force"], -inertia - spring)


def _slope(run: RunUnderTest, values: Array) -> Array:
    return np.asarray(np.gradient(filter_band(run, values), 1.0 / run.rate))


def unlike(first: Array, second: Array) -> float:
    """Return e^2: 0 alike, 1 unrelated, 2 opposite."""
    size = float(np.mean(first**2) + np.mean(second**2))
    return float(np.mean((first - second) ** 2)) / size if size > 0.0 else 0.0


def filter_band(run: RunUnderTest, values: Array) -> Array:
    """Return values, shape (..., N), between 0.5 and 8 Hz (a bench: below 8 Hz, without their mean)."""
    from scipy.signal import sosfiltfilt

    sections, rows = _filter(run.rate, run.recording.header.rig == "seat"), values.shape[-1]
    swinging = values - np.mean(values, axis=-1, keepdims=True)
    return np.asarray(sosfiltfilt(sections, swinging, padlen=min(3 * rows // 4, 100)))


@functools.cache
def _filter(rate: float, on_seat: bool) -> Array:
    from scipy.signal import butter

    high = min(8.0, 0.4 * rate)
    edges = (min(0.5, 0.5 * high), high) if on_seat else high
    return np.asarray(butter(2, edges, "bandpass" if on_seat else "lowpass", fs=rate, output="sos"))


def find_delay(first: Array, second: Array, most: int) -> tuple[int, float]:
    """Return the delay of the first relative to the second in rows, and their correlation at that delay."""
    from scipy.signal import correlate

    product = correlate(first, second, mode="full", method="fft")[len(second) - 1 - most : len(second) + most]
    size = float(np.linalg.norm(first) * np.linalg.norm(second))
    peak = int(np.argmax(product))
    return peak - most, float(product[peak]) / size if size > 0.0 else 0.0
