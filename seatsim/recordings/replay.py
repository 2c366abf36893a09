"""Replay of a scenario against a run of a recording: what drives it, and which part of both is compared."""

import math
from collections.abc import Mapping

import numpy as np

from seatsim.excitations.recording import interpolate_floor
from seatsim.recordings.recording import CURRENTS, Recording
from seatsim.rig.control import LAWS
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.registry import specification_of
from seatsim.simulation.inputs import BenchInputs, RigInputs, SeatInputs
from seatsim.simulation.respond import SEAT_OUTPUTS, respond

LEFT_OUT = 1.0
"""s; start of each run that is left out of the gap, since the simulation starts from rest and has to settle."""
COMPARED = {"seat": SEAT_OUTPUTS, "damper_bench": SEAT_OUTPUTS[-2:]}
"""Recorded outputs that are compared, by rig."""
LEAST_ROWS = 6
"""Rows that must remain after the seconds left out; a quintic spline through a bench's displacement needs as many."""
NOISE_FACTOR = 3.0
"""A channel is compared where its standard deviation is at least this many times its noise."""
_SAME_STEP = 1e-9
"""Part of a step by which a row interval may exceed a whole number of steps, as an allowance for rounding."""


def stands_out(values: Array, noise: float) -> bool:
    """Whether a channel is compared: its standard deviation is at least three times its noise."""
    spread = float(np.std(values)) if values.size else 0.0
    return spread > 0.0 and spread >= NOISE_FACTOR * noise


def select_compared(table: Mapping[str, Array], rig: str, sample_rate: float) -> dict[str, Array]:
    """Return the compared channels of a run without the seconds left out, shape (rows - 1 s,) each."""
    skip = round(LEFT_OUT * sample_rate)
    return {name: table[name][skip:] for name in COMPARED[rig] if name in table}


def recorded_inputs(recording: Recording, table: Mapping[str, Array], largest_step: float) -> RigInputs:
    """Return the inputs of a rig in a run, from the `table` of the run.

    On a seat the inputs are sampled at the largest step, at most `largest_step` in s, that divides the interval between
    rows. Floor acceleration, coil current and temperature are linear between rows; a command is constant until the next
    row. A bench has one step per row.
    """
    interval = 1.0 / recording.header.sample_rate
    if recording.header.rig == "damper_bench":
        noise, gain = recording.channels["displacement"].noise_rms, recording.voltage_gain
        others = {name: table.get(name) for name in ("velocity", *CURRENTS, "damper_temperature")}
        return BenchInputs(interval, table["displacement"], noise, voltage_gain=gain, **others)
    steps = max(1, math.ceil(interval / largest_step - _SAME_STEP))
    return SeatInputs(interpolate_floor(table, steps, interval / steps), interval)


def replay(scenario: Scenario, recording: Recording, run: str) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the measured and the simulated channels of a run that are compared, without its first second.

    Raises:
        InputError: there is no such run, it is too short, or the scenario does not fit the rig.
        RunError: the simulation could not be carried to its end.
    """
    table, rate = recording.table(run), recording.header.sample_rate
    rows = len(next(iter(table.values())))
    if rows < round(LEFT_OUT * rate) + LEAST_ROWS:
        raise InputError(f"{recording.folder}, run {run}: {rows} rows are too short; its first second is left out")
    simulated = replay_table(recording.scenario_of(run, scenario), recording, table)
    return select_compared(table, recording.header.rig, rate), simulated


def note_unused_log(scenario: Scenario, recording: Recording) -> list[str]:
    """Return a sentence where the scenario's own law drives the coil and the recorded command or current does not."""
    logged = [name for name in CURRENTS if name in recording.channels]
    if scenario.control is None or not logged or specification_of(type(scenario.control.law)).replays:
        return []
    law = LAWS.name_of(type(scenario.control.law))
    seen = f"its law '{law}' drives the coil, and the recorded {' and '.join(logged)} do not"
    remedy = "to drive it with what was recorded, state 'controller: {law: replay}' in the scenario"
    return [f"{scenario.name}: {seen}; {remedy}"]


def replay_table(scenario: Scenario, recording: Recording, table: Mapping[str, Array]) -> dict[str, Array]:
    """Return the simulated channels that are compared, driven by the inputs of a table, without the first second."""
    return {name: values for name, values in simulate_table(scenario, recording, table).items() if name in table}


def simulate_table(scenario: Scenario, recording: Recording, table: Mapping[str, Array]) -> dict[str, Array]:
    """Return the same of every output, recorded or not."""
    outputs = respond(scenario, recorded_inputs(recording, table, scenario.solver.step))
    return select_compared(outputs, recording.header.rig, recording.header.sample_rate)
