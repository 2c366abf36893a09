"""The rows of a sweep as its statistics take them: which keys vary, which are texts, which metrics there are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from seatsim.metrics.table import METRICS
from seatsim.sweeps.axes import DISTRIBUTIONS
from seatsim.sweeps.manifest import read_manifest
from seatsim.sweeps.outcome import DONE
from seatsim.sweeps.parts import LEADING
from seatsim.sweeps.read import read_sweep

if TYPE_CHECKING:
    import pandas as pd


class SweepRows(NamedTuple):
    """The rows of a sweep: `usable` without those of failed and unverified runs; `keys` that have more than one value.

    `drawn` are the keys whose values come from a distribution. `metrics` are those that some run has.
    """

    folder: Path
    manifest: Mapping[str, Any]
    every: pd.DataFrame
    usable: pd.DataFrame
    keys: list[str]
    drawn: list[str]
    metrics: list[str]
    units: Mapping[str, str]

    @property
    def texts(self) -> list[str]:
        """The varied keys whose values are no numbers."""
        return [key for key in self.keys if not is_number(self.usable[key])]

    @property
    def is_random(self) -> bool:
        """Whether points are drawn, so that shares of runs estimate probabilities."""
        return bool(self.drawn)


def read_rows(folder: Path) -> SweepRows:
    """Return the rows of a sweep.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    manifest, frame = read_manifest(folder), read_sweep(folder)
    usable = frame[frame.state == DONE]
    named = [name for name in frame.columns if name not in (*LEADING, *METRICS)]
    vary = manifest["configuration"].get("vary", {})
    return SweepRows(
        folder=folder,
        manifest=manifest,
        every=frame,
        usable=usable,
        keys=[key for key in named if frame[key].nunique() > 1],
        drawn=[key for key, stated in vary.items() if isinstance(stated, dict) and set(DISTRIBUTIONS) & set(stated)],
        metrics=[name for name in METRICS if usable[name].notna().any()],
        units=frame.attrs["units"],
    )


def is_number(column: pd.Series[Any]) -> bool:
    """Tell whether a column holds numbers, truth values not among them."""
    return column.dtype.kind in "if"
