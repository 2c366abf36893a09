"""The command that writes a model or controller for other programs: export."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatsim.cli.options import Json, OneScenario, OwnCode, Settings, scenario_settings
from seatsim.cli.terminal import answer, show_progress, warn, wrote_one
from seatsim.schema.errors import InputError, nearest

if TYPE_CHECKING:
    from seatsim.scenario.scenario import Scenario


def export(
    scenario: OneScenario,
    form: Annotated[str, typer.Option("--to", help="fmu2, fmu3, c or mat.")],
    what: Annotated[str, typer.Option("--what", help="rig, damper or controller.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The file to be written.")],
    variant: Annotated[
        str | None,
        typer.Option("--variant", metavar="NAME", help="The variant of the scenario.", show_default="the first"),
    ] = None,
    settings: Settings = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Write a scenario's rig, damper or controller for other programs: as an FMU, as C, or as a MAT file."""
    from seatsim.exchange.block import list_variables
    from seatsim.exchange.export import export as write
    from seatsim.scenario.loading import load

    run = _choose(scenario, load(scenario, scenario_settings(settings)), variant)
    with show_progress() as progress:
        progress(f"exporting {what}")
        block = write(run, form, what, out)
    warn(block.notes)
    wrote_one(out)
    variables = [
        {"name": v.name, "causality": v.causality, "unit": v.unit, "meaning": v.meaning, "start": v.value}
        for v in list_variables(block)
    ]
    answer({"name": block.name, "step": block.step, "variables": variables, "notes": block.notes}, [out])


def _choose(name: str, runs: Sequence[Scenario], variant: str | None) -> Scenario:
    """Return the first run of a variant, or of all, and say so where there are others."""
    known = list(dict.fromkeys(run.label["variant"] for run in runs if "variant" in run.label))
    if variant is not None and variant not in known:
        names = f"its variants: {'; '.join(known)}" if known else "it has no variants"
        raise InputError(f"--variant {variant}: {name} has no such variant{nearest(variant, known)}; {names}")
    chosen = [run for run in runs if variant is None or run.label["variant"] == variant]
    if len(chosen) > 1:
        others = f"; --variant takes another one: {'; '.join(known)}" if variant is None and known else ""
        warn([f"{name} holds {len(chosen)} runs; the first is exported: {chosen[0].title}{others}"])
    return chosen[0]
