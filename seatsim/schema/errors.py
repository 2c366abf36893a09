"""The error tree of seatsim.

SeatsimError            everything that seatsim raises on purpose
├── InputError          a file, a value or a name is wrong (exit status 2, nothing written)
├── OutputError         a file could not be written, such as on a full disk (exit status 1, nothing half-written)
├── RunError            a simulation could not be carried to its end (exit status 1)
└── SynthesisError      a controller with the wanted property does not exist or was not found (exit status 1)
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

_LONGEST = 200
"""Letters of a name from which on none is sought that is near: that takes ever longer, and it is none."""
_LONGEST_MESSAGE = 2000
_Key = TypeVar("_Key")


class SeatsimError(Exception):
    """Base of all errors that seatsim raises on purpose; a message is one line, shortened where a value is endless."""

    exit_status = 1

    def __init__(self, message: str) -> None:
        said = " ".join(message.splitlines())
        super().__init__(said if len(said) <= _LONGEST_MESSAGE else f"{said[:1000]} ... {said[-500:]}")


class InputError(SeatsimError):
    """A file, a value or a name from the user is wrong."""

    exit_status = 2


class OutputError(SeatsimError):
    """A file could not be written, although its place permits it: the disk is full, or failed."""


class RunError(SeatsimError):
    """A simulation could not be carried to its end."""


class SynthesisError(SeatsimError):
    """A controller with the wanted property does not exist, or none was found."""


@contextmanager
def gathered(errors: list[InputError]) -> Iterator[None]:
    """Add the InputError that a part of a file raises meanwhile to a list, so that the other parts are read as well."""
    try:
        yield
    except InputError as error:
        errors.append(error)


def read_each(readers: Mapping[_Key, Callable[[], Any]]) -> dict[_Key, Any]:
    """Return what each of some readers of a file returns, by its key.

    Raises:
        InputError: some of them do; all others are called nevertheless (see `raise_all`).
    """
    found, errors = dict[_Key, Any](), list[InputError]()
    for key, read in readers.items():
        with gathered(errors):
            found[key] = read()
    raise_all(errors)
    return found


@contextmanager
def placed(place: str) -> Iterator[None]:
    """Put before an InputError that is raised meanwhile the place of what is wrong."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}: {error}") from error


def raise_all(errors: Sequence[InputError]) -> None:
    """Raise the first of some errors, none where there is none; its notes (`__notes__`) say each of the others once."""
    if errors:
        first = errors[0]
        first.__notes__ = list(dict.fromkeys(said for error in errors for said in list_sentences(error)))[1:]
        raise first


def list_sentences(error: BaseException) -> list[str]:
    """Return what an error says, and what its notes say of other places of the same file."""
    return [str(error), *getattr(error, "__notes__", ())]


def find_nearest(name: object, known: Iterable[str]) -> str:
    """Return the known name closest to `name`, an empty string where none is close."""
    if len(str(name)) > _LONGEST:
        return ""
    return next(iter(difflib.get_close_matches(str(name), [str(k) for k in known], n=1, cutoff=0.5)), "")


def permit(name: object, known: Collection[str]) -> str:
    """Return `" (did you mean 'x'?); permitted: x, y"`, the end of the error that a name is none of the known ones."""
    return f"{nearest(name, known)}; permitted: {', '.join(known)}"


def nearest(name: object, known: Iterable[str]) -> str:
    """Return `" (did you mean 'x'?)"` for the known name closest to `name`, or an empty string."""
    found = find_nearest(name, known)
    return f" (did you mean '{found}'?)" if found else ""
