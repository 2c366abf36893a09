"""What `seatsim check` does with a file: it is read as the commands would read it; own code is tried for an instant.

A class of the user's own is tried on an example, so that what is wrong with it is said before a run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.characterisation.summary import load_damper
from seatsim.compilation.messages import explain
from seatsim.dampers.base import DAMPERS
from seatsim.effects.base import EFFECTS, off
from seatsim.excitations.recording import RecordedRun
from seatsim.importing.import_map import read_map
from seatsim.recordings.quality.examination import examine, refuse
from seatsim.recordings.recording import HEADER, load_recording
from seatsim.rig.temperature import TemperatureScaling
from seatsim.scenario.describe import KINDS
from seatsim.scenario.loading import load
from seatsim.scenario.numbers import list_doubts
from seatsim.schema.content import IfAny, Joined
from seatsim.schema.errors import InputError, SeatsimError
from seatsim.schema.fields import bounds, default_values, field_names
from seatsim.schema.modules import use
from seatsim.schema.registry import find, name_of, names
from seatsim.schema.yaml_source import Source
from seatsim.simulation.checks import CheckedRun, applicable_checks, check_run
from seatsim.simulation.result import Run
from seatsim.simulation.runs import run_one
from seatsim.sweeps.definition import is_sweep
from seatsim.sweeps.execute import prepare

_EXAMPLE = "em5"
_SECONDS = 0.1
_TRIED = (0.01, 0.1, 0.5)
"""Displacement [m], velocity [m/s] and current [A] at which a damper is asked for its force."""


def _try_class(kind: str, name: str, cls: type) -> list[str]:
    """Return what is doubtful about a class after a tenth of a second on the seat of an example.

    Raises:
        InputError: it cannot be compiled or simulated, or does not do what it promises.
    """
    try:
        return list(_TRIALS[kind](name, cls)) if kind in _TRIALS else []
    except SeatsimError as error:
        raise InputError(f"{kind} {name}: {error}") from error
    except Exception as error:  # the code of somebody else may raise anything
        raise InputError(f"{kind} {name}: {explain(error)}") from error


def _try_damper(name: str, cls: type) -> Iterator[str]:
    values = _choose_values(cls)
    record = cls(**values)
    state = DAMPERS.specification_of(cls).initial
    scaling = TemperatureScaling()
    if not np.isfinite(float(record.force(*_TRIED, scaling, state))):
        raise InputError(f"force{_TRIED} is no finite number")
    if state:
        rates = record.rates(*_TRIED, scaling, state)
        if not isinstance(rates, tuple) or len(rates) != len(state):
            raise InputError(f"rates returns {rates!r}; permitted: a tuple of {len(state)}, such as (0.0,)")
    _simulate({"damper": {"model": name, "parameters": values}})
    return iter(())


def _try_law(name: str, cls: type) -> Iterator[str]:
    _simulate({"controller": {"law": name, **_choose_values(cls)}})
    return iter(())


def _try_effect(name: str, cls: type) -> Iterator[str]:
    specification = EFFECTS.specification_of(cls)
    if not specification.forms:
        yield f"effect {name}: without forms, no diagnosis tries it"
    if specification.by_channel:
        return
    plain = _simulate({"effects": []})
    at_rest = _simulate({"effects": [_state(name, off(cls)._asdict())]})
    if not all(np.allclose(plain[channel], at_rest[channel]) for channel in ("driver_acceleration", "damper_force")):
        raise InputError("changes the rig where it is off: where all parameters are zero, or those of off=...")
    for form in specification.forms:
        _simulate({"effects": [_state(name, {**off(cls)._asdict(), **form.fixed, **form.free})]})


def _state(name: str, values: Mapping[str, object]) -> dict[str, object]:
    return {"effect": name, "parameters": values}


def _choose_values(cls: type) -> dict[str, object]:
    """Return the default of each field, or the middle of its bounds, or 1 where it has none."""
    middles = {field: 0.5 * sum(bounds(cls, field)) for field in field_names(cls)}
    return {field: middle if np.isfinite(middle) else 1.0 for field, middle in middles.items()} | default_values(cls)


def _simulate(settings: dict[str, object]) -> Run:
    return run_one(load(_EXAMPLE, {**settings, "variants": {}, "excitation.duration": _SECONDS})[0])


_TRIALS = {"damper": _try_damper, "law": _try_law, "effect": _try_effect}


class Checked(NamedTuple):
    """A file without errors: what it is, what it holds by name, and what is doubtful about it."""

    kind: str
    holds: list[str]
    warnings: list[str]


class CheckedFile(NamedTuple):
    """A file, and what is known of it."""

    file: Path
    checked: Joined[Checked]
    checks: IfAny[tuple[CheckedRun, ...]] = ()
    """What its runs gave for the checks that it states, with `--run`."""


def run_checks(path: Path) -> tuple[CheckedRun, ...]:
    """Run a scenario and return how it meets the checks that it states.

    Raises:
        InputError: it states none, or one that cannot be made. RunError: a run could not be carried to its end.
    """
    scenarios = [scenario for scenario in load(path) if applicable_checks(scenario)]
    if not scenarios:
        raise InputError(f"{path}: states nothing under 'checks', such as 'checks: {{seat_factor: {{max: 0.9}}}}'")
    return tuple(checked for scenario in scenarios for checked in check_run(run_one(scenario)))


def check_file(path: Path) -> Checked:
    """Read a scenario, recording (or folder), sweep, damper with its parameters, map of `import` or Python file.

    Raises:
        InputError: there is an error in it.
    """
    if path.is_dir() or path.name == HEADER:
        return _check_recording(path if path.is_dir() else path.parent)
    if path.suffix == ".py":
        return _check_code(path)
    stated = Source(path).data if path.exists() else {}
    if {"model", "bench"} & set(stated):
        return Checked("parameters", [name_of("damper", type(load_damper(path).record))], [])
    if is_sweep(stated):
        prepared = prepare(path)
        return Checked("sweep", [f"{prepared.plan.runs} runs over {', '.join(prepared.plan.keys)}"], prepared.doubts)
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
    warnings += [sentence for kind, name in own for sentence in _try_class(kind, name, find(kind, name))]
    return Checked("own code", [f"{kind} {name}" for kind, name in own], warnings)
