"""From a scenario and inputs to what the sensors of the rig say: the one way in which recorded rigs are simulated.

Whatever compares a simulation with a recording comes through here: replay, gap, data checks, diagnosis and the design
of experiments. A run of a recording becomes inputs by `seatsim.recordings.replay.recorded_inputs`.
"""

from __future__ import annotations

import dataclasses

from seatsim.scenario.scenario import Scenario, Start
from seatsim.schema.arrays import Array
from seatsim.simulation.augment import read_sensors
from seatsim.simulation.bench_response import simulate_bench
from seatsim.simulation.inputs import BenchInputs, RigInputs, SeatInputs
from seatsim.simulation.simulate import simulate

SEAT_OUTPUTS = (
    "frame_acceleration", "driver_acceleration", "suspension_displacement", "damper_force", "coil_current",
)  # fmt: skip
"""What the sensors of a seat say, in the order in which they are reported; those of a bench say the last two."""


def respond(scenario: Scenario, inputs: RigInputs, carry_all_effects: bool = False) -> dict[str, Array]:
    """Return what the sensors of a rig say, by channel, shape (rows,) each in SI units.

    The rig starts at rest at x = 0, wherever `scenario.start` puts it, because that is how a recording starts. On a
    seat the step of the simulation is that of the inputs. With `carry_all_effects` the compiled time loop carries every
    registered effect, off where the scenario does not choose it: what tries many effects one after another then shares
    one compiled loop, and the numbers are those without.

    Raises:
        InputError: the scenario does not fit the inputs, or has an effect that a bench has no part for.
        RunError: the solution grew beyond all bounds.
    """
    if isinstance(inputs, BenchInputs):
        return simulate_bench(scenario, inputs, carry_all_effects)
    return _respond_seat(scenario, inputs, carry_all_effects)


def _respond_seat(scenario: Scenario, inputs: SeatInputs, carry_all_effects: bool) -> dict[str, Array]:
    solver = scenario.solver._replace(step=inputs.floor.step)
    at_rest = dataclasses.replace(scenario, solver=solver, start=Start())
    history = simulate(at_rest, inputs.floor, inputs.forces, carry_all_effects or None)
    steps = round(inputs.interval / inputs.floor.step)
    return read_sensors(scenario.effects, inputs.interval, {name: history[name][::steps] for name in SEAT_OUTPUTS})
