"""The nominal scenario of an imported recording: plant, damper and coil of a scenario, driven by what was recorded."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from seatsim.importing.import_map import Rig
from seatsim.scenario.loading import load
from seatsim.schema.errors import InputError
from seatsim.schema.yaml_source import Source

NOMINAL = "nominal.yaml"
KEPT = {
    "seat": ("plant", "driver", "damper", "actuator", "temperature", "effects", "solver"),
    "damper_bench": ("damper", "actuator", "temperature", "effects"),
}
"""Sections of a scenario that state its rig."""
CURRENTS = ("current_command", "command_voltage", "coil_current")


def make_nominal(scenario: str, rig: Rig, recorded: Collection[str]) -> Mapping[str, object]:
    """Return the content of the nominal scenario of a rig with these recorded channels.

    Where no current was recorded, the scenario's constant one is kept.

    Raises:
        InputError: the scenario is wrong, or states no constant current where none is recorded.
    """
    source = load(scenario)[0].source
    if source is None:
        raise InputError(f"{scenario}: states no rig; give the file of a scenario")
    nominal = {key: source.data[key] for key in KEPT[rig] if key in source.data}
    if rig == "damper_bench":
        return nominal
    return nominal | {"controller": _law(source, recorded), "excitation": {"kind": "recording"}}


def _law(source: Source, recorded: Collection[str]) -> dict[str, object]:
    if any(name in recorded for name in CURRENTS):
        return {"law": "replay"}
    law = source.data.get("controller")
    current = law.get("current") if isinstance(law, Mapping) else None
    if current is None:
        problem = "no current was recorded, and the scenario states no constant one"
        raise source.error(
            ("controller",),
            f"{problem}; write controller: {{law: constant, current: 0.0}} with the current that flowed",
        )
    return {"law": "replay", "current": current}
