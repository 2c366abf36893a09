"""What is asked of an identification."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple


class IdentificationSettings(NamedTuple):
    """What is asked of an identification.

    test: globs of the files to hold out. test_fraction: share of every other record, its last part, to hold out.
    fix: numbers of the model that keep a value, by name. ignore_temperature: whether the recorded temperature is no
    input. seed: of the global search.
    """

    test: Sequence[str] = ()
    test_fraction: float = 0.0
    fix: Mapping[str, float] = {}
    ignore_temperature: bool = False
    seed: int = 0
