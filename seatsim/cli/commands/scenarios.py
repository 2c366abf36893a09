"""The commands that take one scenario to other ends than a run: synthesise, export, explore."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatsim.cli.options import OneScenario, Out, Settings, complete, scenario_settings
from seatsim.cli.terminal import announce, answer, show_progress, warn, wrote, wrote_one
from seatsim.schema.errors import InputError, nearest

if TYPE_CHECKING:
    from controllers.synthesis import Design
    from seatsim.cli.terminal import Report
    from seatsim.scenario.scenario import Scenario


_PAGE_EXTRA = 'the page needs an extra; install it with: pip install "seatsim[page]"'


def export(
    scenario: OneScenario,
    form: Annotated[str, typer.Option("--to", autocompletion=complete("fmu2", "fmu3", "c", "mat"))],
    what: Annotated[str, typer.Option("--what", autocompletion=complete("rig", "damper", "controller"))],
    out: Annotated[Path, typer.Option("--out", metavar="FILE")],
    variant: Annotated[str | None, typer.Option("--variant", metavar="NAME", show_default="the first")] = None,
    settings: Settings = None,
) -> None:
    """Write a scenario's rig, damper or controller for other programs: as an FMU, as C, or as a MAT file.

    Options:
        form: fmu2, fmu3, c or mat.
        what: rig, damper or controller.
        out: The file to be written.
        variant: The variant of the scenario.
    """
    from seatsim.exchange.block import ExportedBlock, list_variables
    from seatsim.exchange.export import export as write
    from seatsim.scenario.loading import load

    run = _choose(scenario, load(scenario, scenario_settings(settings)), variant)
    with show_progress() as progress:
        progress(f"exporting {what}")
        block = write(run, form, what, out)
    warn(block.notes)
    wrote_one(out)
    answer(ExportedBlock(block.name, block.step, list_variables(block), block.notes), [out])


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


def synthesise(
    scenario: OneScenario,
    out_folder: Out = None,
    prove_best: Annotated[bool, typer.Option("--global")] = False,
    settings: Settings = None,
) -> None:
    """Synthesise the H-infinity static output feedback of a scenario's plant and weights.

    Options:
        prove_best: Prove that no permitted gain is better by 0.1 % (up to four gains).
    """
    from seatsim.cli.outputs.run_tables import make_design_table
    from seatsim.cli.show_table import show_table
    from seatsim.provenance.statement import write_documented
    from seatsim.scenario.loading import single
    from seatsim.schema.yaml_source import Source
    from seatsim.simulation.checks import measure_clipping

    chosen = single(scenario, scenario_settings(settings))
    with show_progress() as progress:
        design = _synthesise(chosen, progress)
        design = design.prove(progress) if prove_best else design
        design = design.with_clipping(measure_clipping(chosen, design.gain))
    show_table(make_design_table(design, chosen))
    folder = out_folder or Path("out") / chosen.name

    def write(part: Path) -> list[Path]:
        design.save(part / "design.yaml")
        if design.proof is not None:
            design.proof.save(part / "global.json")
        return sorted(part.iterdir())

    paths = write_documented(folder, write, chosen.seed)
    wrote(folder, paths)
    answer(Source(folder / "design.yaml").data, paths)


def _synthesise(scenario: Scenario, progress: Report) -> Design:
    """Return the design of a law that has a synthesis, for the plant of a scenario."""
    from seatsim.rig.designs import SynthesisedLaw
    from seatsim.schema.registry import name_of
    from seatsim.simulation.design import record_floors, settle_travel
    from seatsim.simulation.simulate import measure_peak_travel

    with scenario.placed("controller"):
        if scenario.plant is None or scenario.control is None:
            raise InputError("a damper bench has no controller to synthesise")
        law = settle_travel(scenario, scenario.control, measure_peak_travel)
        if not isinstance(law, SynthesisedLaw):
            name = name_of("law", type(law))
            raise InputError(f"law '{name}' is not synthesised; use 'law: static_output_feedback' with 'weights'")
        control = scenario.control
        return law.synthesis(scenario.plant, lambda: record_floors(scenario, control), progress)


def explore(
    target: Annotated[str, typer.Argument(metavar="[SCENARIO|RECORDING]")] = "quickstart",
    port: Annotated[int, typer.Option("--port", min=0, max=65535, show_default="a free one")] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser")] = False,
) -> None:
    """Open a page on this machine: move driver, temperature, road and controller, or effects, and see what follows.

    Options:
        target: A scenario, an example, or a recording's folder.
        port: Port of loopback.
        no_browser: Print the address and open no browser.
    """
    try:
        from seatsim.page.app import find_target, serve
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] not in ("starlette", "uvicorn"):
            raise
        raise InputError(_PAGE_EXTRA) from error
    path = Path(target)
    folder = path if path.is_dir() else path.parent if path.exists() else Path()
    serve(find_target(path), folder, port, not no_browser, announce)
