"""Replay of a scenario against one run of a recording."""

from __future__ import annotations

from collections.abc import Container, Mapping

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.compared import COMPARED, LEAST_ROWS, LEFT_OUT, select_compared
from seatsim.recordings.inputs import recorded_inputs
from seatsim.recordings.recording import Recording
from seatsim.rig.control import LAWS
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError
from seatsim.schema.registry import specification_of
from seatsim.simulation.respond import respond

Array = NDArray[np.float64]
COMMANDS = ("current_command", "command_voltage")
"""Channels that command the coil."""


def list_compared(scenario: Scenario, rig: str, recorded: Container[str]) -> list[str]:
    """Return the recorded channels that are compared with a scenario.

    A coil current is an input, and so not compared, where it drives the damper in place of a command.
    """
    commanded = any(name in recorded for name in COMMANDS)
    prescribed = not commanded and (scenario.control is None or specification_of(type(scenario.control.law)).replays)
    return [name for name in COMPARED[rig] if name in recorded and not (prescribed and name == "coil_current")]


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
    measured = select_compared(table, recording.header.rig, rate)
    return {name: measured[name] for name in simulated}, simulated


def note_unused_log(scenario: Scenario, recording: Recording) -> list[str]:
    """Return a sentence where the scenario's own law drives the coil and the recorded command or current does not."""
    logged = [name for name in ("current_command", "coil_current") if name in recording.channels]
    if scenario.control is None or not logged or specification_of(type(scenario.control.law)).replays:
        return []
    law = LAWS.name_of(type(scenario.control.law))
    return [
        f"{scenario.name}: its law '{law}' drives the coil, and the recorded {' and '.join(logged)} do not; to drive it"
        " with what was recorded, state 'controller: {law: replay}' in the scenario"
    ]


def replay_table(scenario: Scenario, recording: Recording, table: Mapping[str, Array]) -> dict[str, Array]:
    """Return the simulated channels that are compared, driven by the inputs of a table, without the first second."""
    outputs = simulate_table(scenario, recording, table)
    return {name: outputs[name] for name in list_compared(scenario, recording.header.rig, table)}


def simulate_table(scenario: Scenario, recording: Recording, table: Mapping[str, Array]) -> dict[str, Array]:
    """Return the same of every output, recorded or not."""
    outputs = respond(scenario, recorded_inputs(recording, table, scenario.solver.step))
    return select_compared(outputs, recording.header.rig, recording.header.sample_rate)
