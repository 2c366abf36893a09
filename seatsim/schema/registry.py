"""Names of pluggable parts: built-in ones and a user's own are found the same way.

A plug-in is a module or package that an entry point of the group ``seatsim.plugins`` names; importing it (and its
submodules) runs the decorators that register its classes. A class that is in no plug-in is named directly, as
``"package.module:Class"``; it is registered by the same decorator when its module is imported, which is installed or
one of the files in use (`seatsim.schema.modules`).

Each kind of part has a `Registry` in the module that defines what such a part is: `DAMPERS` in `seatsim.dampers.base`,
`EFFECTS` in `seatsim.effects.base`, `EXCITATIONS` in `seatsim.excitations.base`, `LAWS` in `seatsim.rig.control`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Generic, Protocol, Self, TypeVar, cast

from seatsim.schema.errors import InputError, nearest
from seatsim.schema.modules import import_named, load_plugins, shipped_packages

_T = TypeVar("_T", bound=type)
_P = TypeVar("_P")
_S = TypeVar("_S")


class Record(Protocol):
    """What every `typing.NamedTuple` has; `field_names` and `default_values` read the same from its class."""

    def __init__(self, *values: object, **named: object) -> None: ...

    @property
    def _fields(self) -> tuple[str, ...]: ...

    @property
    def _field_defaults(self) -> Mapping[str, object]: ...

    @property
    def _replace(self) -> Callable[..., Self]: ...

    def _asdict(self) -> Mapping[str, object]: ...


_classes: dict[str, dict[str, type[Record]]] = {}
_specifications: dict[type, object] = {}


class Registry(Generic[_P, _S]):
    """The parts of one kind: classes `_P` by name, and the specification `_S` that each was registered with."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def register(self, name: str, specification: _S) -> Callable[[_T], _T]:
        """Return a class decorator that enters a class under `name`, with its `specification` of facts."""
        return register(self.kind, name, specification)

    def names(self) -> list[str]:
        """List the registered names, sorted."""
        return names(self.kind)

    def classes(self) -> tuple[type[_P], ...]:
        """Return the registered classes, sorted by name."""
        return tuple(cast("type[_P]", _classes[self.kind][name]) for name in self.names())

    def find(self, name: str, beside: Path | None = None) -> type[_P]:
        """Return the class called `name`, or the one that `"package.module:Class"` points to; see `find`.

        Raises:
            InputError: no such name or class, or the class is not registered as this kind.
        """
        return cast("type[_P]", find(self.kind, name, beside))

    def name_of(self, cls: type) -> str:
        """Return the name under which a class is registered."""
        return name_of(self.kind, cls)

    def specification_of(self, cls: type) -> _S:
        """Return the specification that the class was registered with."""
        return cast("_S", _specifications[cls])


def register(kind: str, name: str, specification: object) -> Callable[[_T], _T]:
    """Return a class decorator that enters a class of this `kind` under `name`, with its `specification` of facts.

    Raises:
        InputError: another class has the name; which of the two a scenario means would hang on what was imported last.
    """

    def enter(cls: _T) -> _T:
        known = _classes.get(kind, {}).get(name)
        # A module that is loaded again, as in a notebook, replaces its own classes.
        if known is not None and (known.__module__, known.__qualname__) != (cls.__module__, cls.__qualname__):
            raise InputError(f"{kind} '{name}' is there already, in {known.__module__}; choose another name")
        _classes.setdefault(kind, {})[name] = cls
        _specifications[cls] = specification
        return cls

    return enter


def specification_of(cls: type) -> Any:  # any kind: `Registry.specification_of` knows which
    """Return the specification that the class was registered with."""
    return _specifications[cls]


def initial_state(cls: type) -> tuple[float, ...]:
    """Return the state at rest that a damper, law or effect was registered with; empty where it has no state."""
    return tuple(getattr(_specifications[cls], "initial", ()))


def current_order(cls: type) -> int:
    """Return the degree of a damper's force as a polynomial in the current, 0 where it is none or not stated."""
    return int(getattr(_specifications.get(cls), "current_order", 0))


def name_of(kind: str, cls: type) -> str:
    """Return the name under which a class is registered."""
    return next(name for name, known in _classes[kind].items() if known is cls)


def is_own(cls: type) -> bool:
    """Return whether a class is from a file or package of the user's own, not part of seatsim."""
    return cls.__module__.partition(".")[0] not in shipped_packages()


def names(kind: str) -> list[str]:
    """List the registered names of one kind, sorted."""
    load_plugins()
    return sorted(_classes.get(kind, {}))


def find(kind: str, name: str, beside: Path | None = None) -> type[Record]:
    """Return the class of this `kind` called `name`, or the class that `"package.module:Class"` points to.

    `beside` is the folder of the file that has the name; an error shows how a module that lies there would be named.

    Raises:
        InputError: no such name or class, or the class is not registered as this kind.
    """
    if ":" in name:
        return _import_class(kind, name, beside)
    load_plugins()
    known = _classes.get(kind, {})
    if name not in known:
        permitted = ", ".join(sorted(known))
        raise InputError(
            f"no {kind} is called '{name}'{nearest(name, known)}; permitted: {permitted}, or 'package.module:Class', or"
            " one of a file that --with names"
        )
    return known[name]


def _import_class(kind: str, target: str, beside: Path | None) -> type[Record]:
    module_name, _, class_name = target.partition(":")
    module = import_named(module_name, beside)
    cls: type[Record] | None = getattr(module, class_name, None)
    if cls is None:
        raise InputError(f"module '{module_name}' has no class '{class_name}'{nearest(class_name, vars(module))}")
    if cls not in _classes.get(kind, {}).values():
        raise InputError(f"'{target}' is not a {kind}: decorate the class with the {kind} decorator")
    return cls
