"""What a run gives: channels with units, metrics, and the table over several runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatsim.kernel.loop_data import UNITS as LOOP_UNITS
from seatsim.metrics.table import COMFORT, UNWEIGHTED, Metric
from seatsim.scenario.scenario import Scenario
from seatsim.schema.arrays import Array
from seatsim.schema.content import Unwritten, written

if TYPE_CHECKING:
    import pandas as pd

UNITS = {"time": "s", **LOOP_UNITS, "energy_stored": "J"}
"""Unit of every channel of a history."""
_SHOWN = 10
"""Runs that a result in a terminal shows."""


@dataclass(frozen=True)
class History:
    """The channels of one run by name, shape (N,) each, sampled every `step` seconds; SI units, degrees Celsius.

    `notes` are sentences that the law has for its user after the run.
    """

    step: float
    channels: Mapping[str, Array]
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Array:
        """Return one channel."""
        return self.channels[name]

    def __repr__(self) -> str:
        """Say how long the run is, and which channels there are."""
        return f"<History of {len(self.channels['time'])} rows every {self.step:g} s: {', '.join(self.channels)}>"

    def to_pandas(self) -> pd.DataFrame:
        """Return the channels as columns of a frame, a row for each step."""
        import pandas as pd

        return pd.DataFrame(dict(self.channels))


class Channel(np.ndarray[tuple[int, ...], np.dtype[np.float64]]):
    """A channel of a run: an array of shape (N,) with its `name` and `unit`, not to be written into.

    Name and unit are those of the channel and of parts of it, as `channel[100:]`; of what is computed from it, as
    `channel**2`, both are empty.
    """

    name: str
    unit: str

    def __new__(cls, values: NDArray[np.float64], name: str, unit: str) -> Channel:
        """Return a view of the values with a name and a unit."""
        channel = np.asarray(values, dtype=np.float64).view(cls)
        channel.name, channel.unit = name, unit
        channel.flags.writeable = False
        return channel

    def __array_finalize__(self, other: object) -> None:
        """Give what is made from a channel no name and no unit: numpy does not say what was done to it."""
        self.name = self.unit = ""

    def __getitem__(self, key: Any) -> Any:
        """Return a part of the channel, with its name and unit, or a number."""
        part = super().__getitem__(key)
        if isinstance(part, Channel):
            part.name, part.unit = self.name, self.unit
        return part


class RunName(NamedTuple):
    """The name of a run's scenario, and what sets the run apart from the others of it: variant, swept values."""

    scenario: str
    label: Mapping[str, object]


@dataclass(frozen=True)
class Run:
    """One simulated run: its scenario, its history, its metrics by name, and what its user is warned of.

    `unverified` are the reasons why its figures cannot be relied on, none where they can
    (`seatsim.simulation.validity.list_reasons`).
    """

    scenario: Unwritten[Scenario]
    history: Unwritten[History]
    metrics: dict[str, Metric]
    warnings: tuple[str, ...] = ()
    unverified: tuple[str, ...] = ()

    @property
    @written(joined=True)
    def name(self) -> RunName:
        """The name of its scenario, and what sets it apart."""
        return RunName(self.scenario.name, self.scenario.label)

    @property
    @written()
    def notes(self) -> Sequence[str]:
        """What its history is to be read with."""
        return self.history.notes

    def read_metric(self, name: str) -> float:
        """Return the value of a metric, NaN where the run has none of that name."""
        return self.metrics[name].value if name in self.metrics else float("nan")

    def __repr__(self) -> str:
        """Say which scenario was run, and the figures that the table on the terminal has first."""
        figures = (f"{name} {each.value:.4g} {each.unit}" for name, each in list(self.metrics.items())[:4])
        return f"<Run of {self.scenario.title}: {', '.join(figures)}>"

    def __getitem__(self, name: str) -> Channel:
        """Return a channel with its unit, such as `driver_acceleration`."""
        return Channel(self.history[name], name, UNITS[name])


def rank_runs(runs: Sequence[Run]) -> list[Run]:
    """Return the runs whose figures can be relied on, the most comfortable first; none where fewer than two can.

    They are ranked by the weighted acceleration of the driver, or without weighting where not all have a weighted one.
    """
    known = [run for run in runs if not run.unverified]
    is_weighted = all(np.isfinite(run.read_metric(COMFORT)) for run in known)
    known.sort(key=lambda run: run.read_metric(COMFORT if is_weighted else UNWEIGHTED))
    return known if len(known) > 1 else []


@dataclass(frozen=True)
class Result:
    """The runs of one or several scenarios.

    `failures` says why other runs of the scenarios were not carried to their end. It is the content of `summary.json`.
    """

    runs: Sequence[Run]
    failures: Unwritten[Sequence[str]] = ()

    def __repr__(self) -> str:
        """Show the first runs."""
        left = len(self.runs) - _SHOWN
        lines = [f"<Result of {len(self.runs)} runs>", *map(repr, self.runs[:_SHOWN])]
        return "\n".join([*lines, f"and {left} more: see .table"] if left > 0 else lines)

    def __getitem__(self, name: str) -> Channel:
        """Return a channel of the first run with its unit."""
        return self.runs[0][name]

    @property
    def rows(self) -> list[dict[str, object]]:
        """The metrics of every run by name, after what sets the runs apart, and why they are unverified; SI units."""
        found: list[dict[str, object]] = []
        for run in self.runs:
            metrics, reasons = {name: each.value for name, each in run.metrics.items()}, "; ".join(run.unverified)
            found.append({"scenario": run.scenario.name, **run.scenario.label, **metrics, "unverified": reasons})
        return found

    @property
    def table(self) -> pd.DataFrame:
        """The same as a frame, a row a run."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    def _repr_html_(self) -> str:
        return str(self.table.to_html(index=False, float_format="{:.4g}".format))
