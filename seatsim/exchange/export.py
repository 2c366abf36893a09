"""A scenario, or a part of it, as a file for another program."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from seatsim.exchange.block import Block
from seatsim.exchange.blocks.controller import controller_block
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig_motion import rig_block
from seatsim.exchange.c_source import print_c
from seatsim.exchange.fmu import write_fmu
from seatsim.rig.plant import Plant, control_system, state_space
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError, nearest
from seatsim.schema.files import write_text, write_whole
from seatsim.schema.registry import Record

_LONGEST_NAME = 31
"""Letters that a name in a MAT file may have."""
BLOCKS: dict[str, Callable[[Scenario], Block]]
BLOCKS = {"rig": rig_block, "damper": damper_block, "controller": controller_block}
"""What can be exported."""


def export(scenario: Scenario, form: str, what: str, path: Path) -> Block:
    """Write a scenario's rig, damper or controller to a file and return what was written.

    Args:
        scenario: one run.
        form: "fmu2" or "fmu3" (co-simulation, with sources), "c" (one C99 file) or "mat" (version 5).
        what: "rig", "damper" or "controller".
        path: the file; its folder is made where it is missing.

    Raises:
        InputError: a name is unknown, a model or law has no counterpart in C, there is no C compiler, or the file
            cannot be written.
        RunError: the compiler failed. OutputError: the disk is full.
    """
    for name, known, kind in ((form, FORMATS, "--to"), (what, BLOCKS, "--what")):
        if name not in known:
            raise InputError(f"{kind} {name}: no such export{nearest(name, known)}; permitted: {', '.join(known)}")
    if path.is_dir():
        raise InputError(f"--out {path}: this is a folder; name the file to be written")
    block = BLOCKS[what](scenario)
    FORMATS[form](block, scenario, path)
    return block


def write_mat(block: Block, scenario: Scenario, path: Path) -> None:
    """Write the parameters of a block and, of a seat, its linear plant.

    `plant` holds A, B, C, D with the names of states, inputs and outputs, and A, B1, B2, C1, C2 as the H-infinity
    synthesis takes them; `parameters` holds the numbers of the block, among them those of the law's design.

    Raises:
        InputError: the file cannot be written. OutputError: the disk is full.
    """
    # Takes its time to load, and only this file format needs it.
    from scipy.io import savemat

    content: dict[str, Any] = {"name": block.name, "step": block.step, "parameters": _as_struct(block.parameters)}
    content["notes"] = np.array(block.notes, dtype=object)
    if scenario.plant is not None:
        content["plant"] = _linear_plant(scenario.plant)
    write_whole(path, lambda part: savemat(str(part), content, appendmat=False, oned_as="row"))


def _linear_plant(plant: Plant) -> Mapping[str, object]:
    system, exact = control_system(plant), state_space(plant)
    names = {"states": ["x [m]", "v [m/s]", "xc [m]", "vc [m/s]"]}
    names |= {"inputs": system.input_labels, "outputs": system.output_labels}
    return (
        {name: getattr(system, name) for name in ("A", "B", "C", "D")}
        | {kind: np.array(each, dtype=object) for kind, each in names.items()}
        | {name: getattr(exact, name) for name in ("B1", "B2", "C1", "C2")}
    )


def _as_struct(value: object) -> object:
    """Return a record as a struct, a tuple of numbers as a row or matrix, other tuples as a struct by position."""
    if hasattr(value, "_fields"):
        record: Record = value  # type: ignore[assignment]  # has the fields of one
        items = {name: _as_struct(item) for name, item in record._asdict().items()}
        there = {name: item for name, item in items.items() if not isinstance(item, dict | np.ndarray) or len(item)}
        return {name[:_LONGEST_NAME]: item for name, item in there.items()}
    if isinstance(value, tuple):
        if all(isinstance(item, int | float) for item in value) or all(_is_row(item) for item in value):
            return np.array(value, dtype=float)
        return {type(item).__name__[:_LONGEST_NAME]: _as_struct(item) for item in value}
    return value


def _is_row(item: object) -> bool:
    return isinstance(item, tuple) and not hasattr(item, "_fields") and all(isinstance(v, int | float) for v in item)


FORMATS: dict[str, Callable[[Block, Scenario, Path], object]] = {
    "fmu2": lambda block, scenario, path: write_fmu(block, 2, path),
    "fmu3": lambda block, scenario, path: write_fmu(block, 3, path),
    "c": lambda block, scenario, path: write_text(path, print_c(block)),
    "mat": write_mat,
}
"""What a file can be."""
