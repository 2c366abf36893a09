"""A scenario, or a part of it, as a file for another program."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from seatsim.exchange.blocks.base import Block
from seatsim.exchange.blocks.controller import controller_block
from seatsim.exchange.blocks.damper import damper_block
from seatsim.exchange.blocks.rig import rig_block
from seatsim.exchange.c_file import write_c
from seatsim.exchange.fmu import write_fmu
from seatsim.exchange.matlab import write_mat
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import InputError, nearest

BLOCKS: dict[str, Callable[[Scenario], Block]] = {
    "rig": rig_block, "damper": damper_block, "controller": controller_block,
}  # fmt: skip
"""What can be exported."""
FORMATS: dict[str, Callable[[Block, Scenario, Path], None]] = {
    "fmu2": lambda block, scenario, path: write_fmu(block, 2, path),
    "fmu3": lambda block, scenario, path: write_fmu(block, 3, path),
    "c": lambda block, scenario, path: write_c(block, path),
    "mat": write_mat,
}
"""What a file can be."""


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
