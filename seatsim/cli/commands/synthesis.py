"""The command that designs a controller: synthesise."""

from __future__ import annotations

from pathlib import Path

from seatsim.cli.options import Json, OneScenario, Out, OwnCode, Settings, scenario_settings
from seatsim.cli.terminal import answer, show_progress, wrote


def synthesise(
    scenario: OneScenario,
    out_folder: Out = None,
    settings: Settings = None,
    own_code: OwnCode = None,
    as_json: Json = False,
) -> None:
    """Synthesise the H-infinity static output feedback of a scenario's plant and weights."""
    from seatsim.cli.design_table import design_table
    from seatsim.cli.show_table import show_table
    from seatsim.provenance.manifest import write_documented
    from seatsim.scenario.loading import single
    from seatsim.scenario.synthesis import synthesise_design
    from seatsim.schema.yaml_source import Source

    chosen = single(scenario, scenario_settings(settings))
    with show_progress() as progress:
        design = synthesise_design(chosen, progress)
    show_table(design_table(design, chosen))
    folder = out_folder or Path("out") / chosen.name

    def write(part: Path) -> list[Path]:
        design.save(part / "design.yaml")
        return [part / "design.yaml"]

    paths = write_documented(folder, write, chosen.seed)
    wrote(folder, paths)
    answer(Source(folder / "design.yaml").data, paths)
