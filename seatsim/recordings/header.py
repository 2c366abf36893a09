"""What `recording.yaml` states at its top and of each run: numbers, tolerances, runs and what was changed for them."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Literal, NamedTuple

from seatsim.scenario.numbers import PARAMETERS, check_key, check_number, list_numbers
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import nearest
from seatsim.schema.fields import param
from seatsim.schema.text import explain_bad_name
from seatsim.schema.validation import build, check_value
from seatsim.schema.yaml_source import Source

USUAL = 0.02
"""Fraction to which parameters are taken to be known where a recording does not say."""
NOT_STATED = "parameter_tolerance is not stated"
"""How the note begins that says so."""
_DEFAULT = "default"
"""Key of the tolerance of all parameters that a mapping of tolerances does not name."""
Tolerance = float | Literal["fitted"]
"""Fraction to which a parameter is known, or `fitted` where it was fitted to such data."""
Tolerances = Tolerance | Mapping[str, Tolerance]
_OfRuns = Literal["rate", "jump", "short", "duplicate", "repeat", "still"]
_OfChannels = Literal["constant", "clipped", "stuck", "doubled", "sign", "unit", "exchange", "late"]
Refusal = Literal[_OfRuns, _OfChannels]
"""Checks of the data because of which a recording is refused, unless its owner accepts what they find."""


class _Fraction(NamedTuple):
    """A tolerance that is a number."""

    parameter_tolerance: Annotated[float, param("-", "fraction to which parameters are known", low=0, high=1)]


class Header(NamedTuple):
    """What stands at the top of a recording.

    `parameter_tolerance` is one tolerance, or a mapping of them by dotted key with one under `default`, None where none
    is stated. `model_error` is the share of each channel's local amplitude that the nominal's form is known to miss,
    None where none is stated. `accept` names the checks of the data that the rig's owner overrules.
    """

    rig: Literal["seat", "damper_bench"]
    sample_rate: Annotated[float, param("Hz", "rows per second", above=0, high=1e6)]
    nominal: str
    parameter_tolerance: Tolerances | None = None
    model_error: Annotated[float | None, param("-", "share of the local amplitude missed", low=0, high=1)] = None
    accept: tuple[Refusal, ...] = ()

    @property
    def default_tolerance(self) -> Tolerance:
        """Tolerance of the parameters that have none of their own."""
        stated = self.parameter_tolerance
        if isinstance(stated, Mapping):
            return stated.get(_DEFAULT, USUAL)
        return USUAL if stated is None else stated

    @property
    def own_tolerances(self) -> dict[str, Tolerance]:
        """Tolerances of single parameters by dotted key."""
        stated = self.parameter_tolerance
        return {key: value for key, value in stated.items() if key != _DEFAULT} if isinstance(stated, Mapping) else {}


class RunEntry(NamedTuple):
    """One run of a recording.

    `repeat_of` names the run whose excitation it repeats, `set` holds what the rig's owner changed for it on purpose:
    values of the nominal scenario by dotted key.
    """

    name: str
    file: str
    repeat_of: str | None = None
    note: str | None = None
    set: Mapping[str, float] = {}


def read_tolerances(value: object, source: Source) -> Tolerances:
    """Return `parameter_tolerance` as a recording states it: a number, `fitted`, or a mapping by dotted key."""
    if isinstance(value, Mapping):
        return {str(key): _tolerance(each, source, ("parameter_tolerance", str(key))) for key, each in value.items()}
    return _tolerance(value, source, ("parameter_tolerance",))


def _tolerance(value: object, source: Source, keys: tuple[str, ...]) -> Tolerance:
    if value == "fitted":
        return "fitted"
    if isinstance(value, str):
        problem = f"'{value}' is not permitted{nearest(value, ['fitted'])}"
        raise source.error(keys, f"{problem}; permitted: a fraction from 0 to 1, fitted, or a mapping by dotted key")
    check_value(_Fraction(USUAL), "parameter_tolerance", value, source, keys)
    assert isinstance(value, int | float)
    return value


def read_runs(entries: object, source: Source) -> dict[str, RunEntry]:
    """Return the runs of a recording by name, at least one.

    Raises:
        InputError: a key is wrong, a name is given twice, a file lies elsewhere, or a run repeats one that is not there
            or was set otherwise.
    """
    if not isinstance(entries, list) or not entries:
        raise source.error(("runs",), "a recording has at least one run; write '- {name: run-a, file: run-a.csv.gz}'")
    runs: dict[str, RunEntry] = {}
    folder = source.path.parent.resolve()
    for index, entry in enumerate(entries):
        run: RunEntry = build(RunEntry, entry, source, ("runs", index))
        if not (folder / run.file).resolve().is_relative_to(folder):
            problem = "leads out of the folder of the recording, so that any file could be taken for a run"
            raise source.error(("runs", index, "file"), f"{run.file!r} {problem}; copy the file into the folder")
        problem = explain_bad_name(run.name)
        if problem:
            raise source.error(("runs", index, "name"), f"{run.name!r} {problem}")
        if run.name in runs:
            raise source.error(("runs", index, "name"), f"'{run.name}' is the name of two runs; name each once")
        runs[run.name] = run
    for index, run in enumerate(runs.values()):
        if run.repeat_of is not None:
            _check_repeat(run, run.repeat_of, runs, source, index)
    return runs


def _check_repeat(run: RunEntry, repeated: str, runs: Mapping[str, RunEntry], source: Source, index: int) -> None:
    keys = ("runs", index, "repeat_of")
    if repeated not in runs:
        permitted = f"{nearest(repeated, runs)}; permitted: {', '.join(runs)}"
        raise source.error(keys, f"no run is called '{repeated}'{permitted}")
    if dict(runs[repeated].set) != dict(run.set):
        raise source.error(keys, f"'{repeated}' has another 'set'; a repeat is of the same rig: leave out repeat_of")


def check_against(nominal: Scenario, header: Header, runs: Iterable[RunEntry], source: Source) -> None:
    """Raise InputError at a dotted key that the nominal scenario does not have, or a value that it does not permit."""
    known = [key for key in list_numbers(nominal) if key.startswith(tuple(f"{each}." for each in PARAMETERS))]
    for key in header.own_tolerances:
        check_key(key, [_DEFAULT, *known], source, ("parameter_tolerance", key))
    for index, run in enumerate(runs):
        for key, value in run.set.items():
            check_number(nominal, key, value, source, ("runs", index, "set", key))
