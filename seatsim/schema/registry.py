"""Names of pluggable parts: built-in ones and a user's own are found the same way.

A plug-in is a module or package that an entry point of the group ``seatsim.plugins`` names; importing it (and its
submodules) runs the decorators that register its classes. A class that is in no plug-in is named directly, as
``"package.module:Class"``; it is registered by the same decorator when its module is imported.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from functools import cache
from importlib.metadata import entry_points
from typing import Any, TypeVar

from seatsim.schema.errors import InputError, nearest

T = TypeVar("T", bound=type)

_classes: dict[str, dict[str, type]] = {}
_specifications: dict[type, Any] = {}


def register(kind: str, name: str, specification: Any) -> Callable[[T], T]:
    """Return a class decorator that enters a class of this `kind` under `name`, with its `specification` of facts."""

    def enter(cls: T) -> T:
        _classes.setdefault(kind, {})[name] = cls
        _specifications[cls] = specification
        return cls

    return enter


def specification_of(cls: type) -> Any:
    """Return the card that the class was registered with."""
    return _specifications[cls]


def name_of(kind: str, cls: type) -> str:
    """Return the name under which a class is registered."""
    return next(name for name, known in _classes[kind].items() if known is cls)


def names(kind: str) -> list[str]:
    """List the registered names of one kind, sorted."""
    _load_plugins()
    return sorted(_classes.get(kind, {}))


def find(kind: str, name: str) -> type:
    """Return the class of this `kind` called `name`, or the class that `"package.module:Class"` points to.

    Raises:
        InputError: no such name or class, or the class is not registered as this kind.
    """
    if ":" in name:
        return _import_class(kind, name)
    _load_plugins()
    known = _classes.get(kind, {})
    if name not in known:
        permitted = ", ".join(sorted(known))
        raise InputError(
            f"no {kind} is called '{name}'{nearest(name, known)}; permitted: {permitted}, or 'package.module:Class'"
        )
    return known[name]


def _import_class(kind: str, target: str) -> type:
    module_name, _, class_name = target.partition(":")
    try:
        module = importlib.import_module(module_name)
    except ImportError as error:
        raise InputError(f"cannot import '{module_name}' for {kind} '{target}': {error}") from error
    cls = getattr(module, class_name, None)
    if cls is None:
        raise InputError(f"module '{module_name}' has no class '{class_name}'{nearest(class_name, vars(module))}")
    if cls not in _classes.get(kind, {}).values():
        raise InputError(f"'{target}' is not a {kind}: decorate the class with the {kind} decorator")
    found: type = cls
    return found


@cache
def _load_plugins() -> None:
    for point in entry_points(group="seatsim.plugins"):
        package = importlib.import_module(point.value)
        for module in pkgutil.iter_modules(getattr(package, "__path__", ())):
            importlib.import_module(f"{point.value}.{module.name}")
