"""Two recordings of one rig as one: the runs of both, with the channels that both have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from seatsim.recordings.header import RunEntry
from seatsim.recordings.recording import CURRENTS, HEADER, Recording
from seatsim.schema.errors import InputError


def join_recordings(first: Recording, second: Recording) -> tuple[Recording, list[str]]:
    """Return the runs of two recordings as one recording, and sentences on what differs between them.

    Nominal scenario, tolerances and model error are those of the first; what either accepts is accepted. A run of the
    second whose name is taken gets `after-` before it; the larger noise of a channel counts.

    Raises:
        InputError: rig, sample rate or nominal scenario differ, or the recordings share no channel of the current.
    """
    _check_alike(first, second)
    shared = [name for name in first.channels if name in second.channels]
    both = {name: (first.channels[name], second.channels[name]) for name in shared}
    channels = {name: max(entries, key=lambda entry: entry.noise_rms) for name, entries in both.items()}
    runs = first.runs | {entry.name: entry for entry in _rename(first, second)}
    header = first.header._replace(accept=(*first.header.accept, *second.header.accept))
    return replace(first, header=header, runs=runs, channels=channels), [*_say(first, second, shared)]


def _check_alike(first: Recording, second: Recording) -> None:
    """Raise InputError where two recordings cannot be of one rig, driven in one way."""
    place = second.folder / HEADER
    for key in ("rig", "sample_rate"):
        stated, other = getattr(second.header, key), getattr(first.header, key)
        if stated != other:
            raise InputError(f"{place}, {key}: {stated} is not permitted beside {first.folder / HEADER}: {key} {other}")
    if first.voltage_gain != second.voltage_gain and {"command_voltage"} <= set(first.channels) & set(second.channels):
        gains = f"{second.voltage_gain:g} A/V is not permitted beside {first.voltage_gain:g} A/V"
        raise InputError(f"{place}, actuator.gain: {gains} of {first.folder / HEADER}")
    for name in first.channels:
        if name in second.channels and first.conversions.get(name) != second.conversions.get(name):
            problem = f"{place}, channels.{name}.unit: is another one than in {first.folder / HEADER}; use one unit"
            raise InputError(problem)
    _check_nominals(first, second)
    driven = [{name for name in CURRENTS if name in each.channels} for each in (first, second)]
    if any(driven) and not driven[0] & driven[1]:
        named = [" and ".join(sorted(each)) or "no current" for each in driven]
        problem = f"has {named[1]}, and {first.folder / HEADER} has {named[0]}; record one of them in both"
        raise InputError(f"{place}, channels: {problem}")


def _check_nominals(first: Recording, second: Recording) -> None:
    one, other = first.nominal, second.nominal
    if type(one.damper.record) is not type(other.damper.record) or one.effects != other.effects:
        raise InputError(f"{second.nominal_file}: has another damper model or other effects than {first.nominal_file}")
    numbers, others = first.nominal_numbers, second.nominal_numbers
    for key in [*numbers, *others]:
        if numbers.get(key) != others.get(key):
            text = f"{key}: {others.get(key)} is not permitted beside {numbers.get(key)} of {first.nominal_file}"
            advice = "state under 'set' of its runs what was changed on purpose"
            raise InputError(f"{second.nominal_file}, {text}; {advice}")


def _rename(first: Recording, second: Recording) -> Iterator[RunEntry]:
    """Yield the runs of the second recording under free names, with the full paths of their tables."""
    names: dict[str, str] = {}
    for name in second.runs:
        free = name
        while free in first.runs or free in names.values():
            free = f"after-{free}"
        names[name] = free
    for name, entry in second.runs.items():
        repeated = names[entry.repeat_of] if entry.repeat_of is not None else None
        file = str((second.folder / entry.file).resolve())
        yield entry._replace(name=names[name], file=file, repeat_of=repeated)


def _say(first: Recording, second: Recording, shared: list[str]) -> Iterator[str]:
    """Yield a sentence on each thing that differs and is not an error."""
    for one, other in ((first, second), (second, first)):
        dropped = [name for name in one.channels if name not in shared]
        if dropped:
            yield (
                f"{', '.join(dropped)}: left out, since {other.folder.name} does not have it;"
                f" what it alone shows needs a diagnosis of {one.folder.name} alone"
            )
    for name in shared:
        noises = first.channels[name].noise_rms, second.channels[name].noise_rms
        if noises[0] != noises[1]:
            yield f"{name}: noise_rms is stated as {noises[0]:g} and {noises[1]:g}; the larger counts"
    for key in ("parameter_tolerance", "model_error"):
        if getattr(first.header, key) != getattr(second.header, key):
            yield f"{key}: that of {first.folder.name} counts, {second.folder.name} states another"
