"""The tests that a bench made of a damper, made of a damper model."""

import math
from collections.abc import Sequence
from pathlib import Path

from seatsim.characterisation.rows import Row
from seatsim.characterisation.sheet import PeakForce
from seatsim.characterisation.tabulate import make_sheet
from seatsim.scenario.scenario import DamperChoice
from seatsim.scenario.sections import read_damper
from seatsim.schema.yaml_source import Source
from seatsim.simulation.damper_bench import SineTest, sine_test

_SETTLED = 3.0
"""Seconds a sine runs at least before its last cycle is taken: models forget their start in that time."""


def load_damper(path: Path) -> DamperChoice:
    """Return the damper of a file, `{model: NAME, parameters: {...}, temperature_factors: {...}}`.

    It may stand under `damper`, as a scenario has it.

    Raises:
        InputError: the file is not as described.
    """
    source = Source(path)
    if "damper" in source.data:
        return read_damper(source.data["damper"], source, ("damper",))
    return read_damper(source.data, source, ())


def model_peaks(choice: DamperChoice, rows: Sequence[Row], window: float) -> list[PeakForce]:
    """Return the peak forces of a model in the tests of measured rows, each at the temperature that the row states.

    Raises:
        RunError: the damper's state ran away in one of the tests.
    """
    modelled = [row._replace(loop=_test_sine(choice, row)) for row in rows if row.loop is not None]
    return make_sheet(modelled, [], window).peak_forces


def _test_sine(choice: DamperChoice, row: Row) -> SineTest:
    """Return a cycle of a row's sine after which the model has forgotten its start."""
    warm = row.temperature if math.isfinite(row.temperature) else choice.factors.reference
    cycles = max(3, math.ceil(_SETTLED * row.frequency) + 1)
    test = sine_test(choice.record, row.amplitude, row.frequency, row.current, warm, choice.factors, cycles)
    return test._replace(time=test.time - test.time[0])
