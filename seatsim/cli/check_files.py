"""What `seatsim check` does with a file: it is read as the commands would read it; own code is tried for an instant."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from seatsim.characterisation.model_tests import load_specimen
from seatsim.cli.trial import try_class
from seatsim.cosimulation.description import describe_unit
from seatsim.excitations.recording import RecordedRun
from seatsim.importing.import_map import read_map
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.scenario.describe import KINDS
from seatsim.scenario.loading import load
from seatsim.scenario.plausibility import list_doubts
from seatsim.schema.modules import UNIT, use
from seatsim.schema.registry import find, names
from seatsim.schema.yaml_source import Source
from seatsim.sweeps.definition import is_sweep
from seatsim.sweeps.execute import prepare


class Checked(NamedTuple):
    """A file without errors: what it is, what it holds by name, and what is doubtful about it."""

    kind: str
    holds: list[str]
    warnings: list[str]


def check_file(path: Path) -> Checked:
    """Read a scenario, recording (or folder), sweep, damper with its parameters, map of `import`, Python file or FMU.

    Raises:
        InputError: there is an error in it.
    """
    if path.is_dir() or path.name == HEADER:
        return _check_recording(path if path.is_dir() else path.parent)
    if path.suffix in (".py", UNIT):
        return _check_code(path) if path.suffix == ".py" else _check_unit(path)
    stated = Source(path).data if path.exists() else {}
    if {"model", "bench"} & set(stated):
        return Checked("parameters", [load_specimen(None, path).name], [])
    if is_sweep(stated):
        return _check_sweep(path)
    if "channels" in stated:
        found = read_map(path)
        return Checked(f"map of a {found.rig}", list(found.channels), [])
    return _check_scenario(path)


def _check_scenario(path: Path) -> Checked:
    scenarios = load(path)
    # Floors may come from files, which are read when they are asked for.
    for scenario in {repr((each.excitation, each.seed)): each for each in scenarios}.values():
        # That of a recording's nominal scenario is filled in when it is replayed.
        if scenario.excitation not in (None, RecordedRun()):
            with scenario.placed("excitation"):
                scenario.excitation.floor(scenario.solver.step, scenario.seed)
    doubts = dict.fromkeys(sentence for scenario in scenarios for sentence in list_doubts(scenario))
    return Checked("scenario", [scenario.title for scenario in scenarios], list(doubts))


def _check_sweep(path: Path) -> Checked:
    prepared = prepare(path)
    keys = ", ".join(prepared.plan.keys)
    return Checked("sweep", [f"{prepared.plan.runs} runs over {keys}"], prepared.doubts)


def _check_recording(folder: Path) -> Checked:
    recording = load_recording(folder)
    examination = examine(recording)
    refuse(examination)
    return Checked("recording", list(recording.runs), examination.sentences)


def _check_code(path: Path) -> Checked:
    use(path)
    module = path.stem
    own = [(kind, name) for kind in KINDS for name in names(kind) if find(kind, name).__module__ == module]
    warnings = [] if own else ["no class is registered: put a decorator such as @damper(...) before it"]
    warnings += [sentence for kind, name in own for sentence in try_class(kind, name, find(kind, name))]
    return Checked("own code", [f"{kind} {name}" for kind, name in own], warnings)


def _check_unit(path: Path) -> Checked:
    unit = describe_unit(path)
    held = [f"{v.causality} {name}" for name, v in unit.variables.items() if v.causality in ("input", "output")]
    return Checked(f"FMU of version {unit.version}", held, [])
