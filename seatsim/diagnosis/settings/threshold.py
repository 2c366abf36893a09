"""What is stated of a threshold beside its value."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, Protocol, get_type_hints

SIMULATED_RIGS = "on simulated rigs whose effects have other functional forms than the candidates"
NUMERICAL = "numerically: the result does not depend on it"
CONVENTION = "by convention"


class Threshold(NamedTuple):
    """Unit and meaning of a threshold, what is lost by raising or lowering it, and how its value was chosen."""

    unit: str
    meaning: str
    trade_off: str
    chosen: str


class Settings(Protocol):
    """A NamedTuple whose annotations carry a `Threshold` each."""

    @property
    def _fields(self) -> tuple[str, ...]: ...


def list_thresholds(settings: type[Settings]) -> Iterator[tuple[str, Threshold]]:
    """Yield the name of every field of a group of settings with what is stated of it, in order."""
    for name, hint in get_type_hints(settings, include_extras=True).items():
        for stated in getattr(hint, "__metadata__", ()):
            if isinstance(stated, Threshold):
                yield name, stated
