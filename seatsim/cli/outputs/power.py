"""The power of a diagnosis on a rig as a table."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from seatsim.blind.carrier.power import SIZES, Power


def make_power_table(powers: Sequence[Power]) -> Table:
    """Return for each effect the smallest size that is found, what that is, and how many draws were found by size."""
    table = Table(title="smallest size found in nine of ten draws, in std of a compared channel", title_justify="left")
    for heading in ("effect", "smallest", "which is", *(f"{size:g}" for size in SIZES)):
        table.add_column(heading, justify="left" if heading in ("effect", "which is") else "right")
    for power in powers:
        smallest = "-" if power.smallest is None else f"{power.smallest:g}"
        meaning = ", ".join(f"{name} {value:.3g}" for name, value in power.parameters().items())
        table.add_row(power.effect, smallest, meaning, *(_count(power, size) for size in SIZES))
    return table


def _count(power: Power, size: float) -> str:
    if size not in power.trials:
        return ""
    found = [trial.found for trial in power.trials[size] if trial.parameters is not None]
    return f"{sum(found)}/{len(found)}" if found else "too large"
