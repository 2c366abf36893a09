"""Words that a sealed label may hold: kinds of cases, the contract's effects, the blocks of a rig."""

from __future__ import annotations

from typing import Literal, Required, TypedDict, get_args

Kind = Literal["none", "one", "two", "outside"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""No effect, one or two effects of the library, something outside the library."""
_CarriedKind = Literal["carried", "untouched"]
"""One effect on a measured recording, and such a recording as it was measured, of which nobody knows what is true."""
Block = Literal["damper", "coil", "suspension", "cushion", "driver", "floor", "sensor"]
BLOCKS: tuple[Block, ...] = get_args(Block)
_LIBRARY = {
    "damper": (
        "thermal_fade gas_spring asymmetry preyield_hysteresis magnetic_saturation remanence free_play seal_friction"
    ),
    "coil": "lag asymmetric_lag delay current_limit",
    "suspension": "friction end_stop progressive_spring",
    "cushion": "hardening separation",
    "driver": "mass biodynamics",
    "floor": "unmeasured_input",
    "sensor": "gain bias lag clock_skew",
}
EFFECTS = tuple(f"{block}.{name}" for block, names in _LIBRARY.items() for name in names.split())
"""The library of the contract, section 5, written again: the makers share no code with the candidates."""


class Label(TypedDict, total=False):
    """What is true of a case. Lists go in parallel, one entry for each fault; a hand-made label may hold less."""

    kind: Required[Kind | _CarriedKind]
    effects: Required[list[str]]
    """Effects of the library that are at work; empty outside it."""
    blocks: Required[list[str]]
    """Block of each fault."""
    forms: list[str]
    """Name of each fault scenario."""
    severities: list[float]
    materialities: list[float]
    """Of each fault beside the others; 1 is the material limit."""
    net_materialities: list[float]
    """The same, after what a refit inside the parameter tolerance takes away."""
    shapes: list[dict[str, float]]
    """Parameters of each fault; on a measured recording under the names that the effect's own parameters have."""
    faulty_channels: list[str]
    overlap: float
    """Collinearity of the responses to two faults, 0..1."""
    nominal: str
    """Model of the nominal damper."""
    missing: list[str]
    """Channels that are not recorded."""
    temperatures: list[float]
    """Of the damper at the start of each run, degC."""
    background: float
    """Random force on the frame, N rms."""
    sample_rate: float
    """Hz."""
    tolerance: float
    """Relative error of nominal parameters that the owner states."""
    rig: dict[str, float]
    """Nominal parameters of seat, damper and coil."""
    order: dict[str, object]
    """What the case was ordered to be, see `make.draw_case.CaseSpecification`."""
