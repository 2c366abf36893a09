"""Linear models and parameters as a MAT file of version 5, which MATLAB, Octave and scipy read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from seatsim.exchange.blocks.base import Block
from seatsim.rig.plant import Plant, control_system, state_space
from seatsim.scenario.scenario import Scenario
from seatsim.schema.files import write_whole
from seatsim.schema.registry import Record

LONGEST_NAME = 31
"""Letters that a name in such a file may have."""


def write_mat(block: Block, scenario: Scenario, path: Path) -> None:
    """Write the parameters of a block and, of a seat, its linear plant.

    `plant` holds A, B, C, D with the names of states, inputs and outputs, and A, B1, B2, C1, C2 as the H-infinity
    synthesis takes them; `parameters` holds the numbers of the block, among them those of the law's design.

    Raises:
        InputError: the file cannot be written. OutputError: the disk is full.
    """
    # Takes its time to load, and only this file format needs it.
    from scipy.io import savemat

    content: dict[str, Any] = {
        "name": block.name,
        "step": block.step,
        "parameters": _as_struct(block.parameters),
        "notes": np.array(block.notes, dtype=object),
    }
    if scenario.plant is not None:
        content["plant"] = _linear_plant(scenario.plant)
    write_whole(path, lambda part: savemat(str(part), content, appendmat=False, oned_as="row"))


def _linear_plant(plant: Plant) -> dict[str, Any]:
    system, exact = control_system(plant), state_space(plant)
    return {
        "A": system.A, "B": system.B, "C": system.C, "D": system.D,
        "states": np.array(["x [m]", "v [m/s]", "xc [m]", "vc [m/s]"], dtype=object),
        "inputs": np.array(system.input_labels, dtype=object),
        "outputs": np.array(system.output_labels, dtype=object),
        "B1": exact.B1, "B2": exact.B2, "C1": exact.C1, "C2": exact.C2,
    }  # fmt: skip


def _as_struct(value: object) -> Any:
    """Return a record as a struct, a tuple of numbers as a row or matrix, other tuples as a struct by position."""
    if hasattr(value, "_fields"):
        record: Record = value  # type: ignore[assignment]  # has the fields of one
        items = {name: _as_struct(item) for name, item in record._asdict().items()}
        return {name[:LONGEST_NAME]: item for name, item in items.items() if not _is_nothing(item)}
    if isinstance(value, tuple):
        if all(isinstance(item, int | float) for item in value) or all(_is_row(item) for item in value):
            return np.array(value, dtype=float)
        return {type(item).__name__[:LONGEST_NAME]: _as_struct(item) for item in value}
    return value


def _is_row(item: object) -> bool:
    return isinstance(item, tuple) and not hasattr(item, "_fields") and all(isinstance(v, int | float) for v in item)


def _is_nothing(item: object) -> bool:
    return isinstance(item, dict | np.ndarray) and len(item) == 0
