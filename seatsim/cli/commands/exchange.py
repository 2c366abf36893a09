"""The command that writes a model or controller for other programs: export."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatsim.cli.options import Json, OneScenario, OwnCode, Settings, scenario_settings
from seatsim.cli.terminal import answer, show_progress, warn, wrote_one


def export(
    scenario: OneScenario,
    form: Annotated[str, typer.Option("--to", help="fmu2, fmu3, c or mat.")],
    what: Annotated[str, typer.Option("--what", help="rig, damper or controller.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The file to be written.")],
    settings: Settings = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Write a scenario's rig, damper or controller for other programs: as an FMU, as C, or as a MAT file."""
    from seatsim.exchange.export import export as write
    from seatsim.exchange.variables import list_variables
    from seatsim.scenario.loading import load

    runs = load(scenario, scenario_settings(settings))
    if len(runs) > 1:
        warn([f"{scenario} holds {len(runs)} runs; the first is exported: {runs[0].title}"])
    with show_progress() as progress:
        progress(f"exporting {what}")
        block = write(runs[0], form, what, out)
    warn(block.notes)
    wrote_one(out)
    variables = [
        {"name": v.name, "causality": v.causality, "unit": v.unit, "meaning": v.meaning, "start": v.value}
        for v in list_variables(block)
    ]
    answer({"name": block.name, "step": block.step, "variables": variables, "notes": block.notes}, [out])
