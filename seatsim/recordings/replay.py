"""Replay of a scenario against one run of a recording."""

from __future__ import annotations

from collections.abc import Mapping

from seatsim.recordings.compared import LEAST_ROWS, LEFT_OUT, select_compared
from seatsim.recordings.inputs import recorded_inputs
from seatsim.recordings.recording import Recording
from seatsim.rig.control import LAWS
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.errors import InputError
from seatsim.schema.registry import specification_of
from seatsim.simulation.respond import respond


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
    return {name: values for name, values in simulate_table(scenario, recording, table).items() if name in table}


def simulate_table(scenario: Scenario, recording: Recording, table: Mapping[str, Array]) -> dict[str, Array]:
    """Return the same of every output, recorded or not."""
    outputs = respond(scenario, recorded_inputs(recording, table, scenario.solver.step))
    return select_compared(outputs, recording.header.rig, recording.header.sample_rate)
