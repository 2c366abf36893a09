"""Files of the report of a sweep: `report.html`, `table.csv`, `sensitivity.csv`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import NamedTuple

from seatsim.provenance.manifest import write_documented
from seatsim.report.sweep import state_importance, write_sweep_report
from seatsim.schema.files import write_together, write_whole
from seatsim.schema.text import disarm
from seatsim.sweeps.statistics.rows import Exceedance, count_exceedances, read_rows, tabulate_quantiles
from seatsim.sweeps.statistics.sensitivity import Sensitivities, analyse_sensitivity, tabulate_sensitivities


class SweepReport(NamedTuple):
    """What a report says, and the files that hold it."""

    sentence: str
    exceeded: list[Exceedance]
    sensitivities: Sensitivities
    paths: list[Path]


def report_sweep(folder: str | Path, out: str | Path | None = None) -> SweepReport:
    """Write the report of a sweep to the folder `out`, or to that of the sweep.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    folder = Path(folder)
    out = Path(out or folder)
    rows = read_rows(folder)
    quantiles, found, exceeded = tabulate_quantiles(rows), analyse_sensitivity(rows), count_exceedances(rows)
    sensitivities = tabulate_sensitivities(found)
    # In the folder of the sweep the manifest is that of the sweep.
    write = write_together if out.resolve() == folder.resolve() else write_documented
    paths = write(
        out,
        lambda part: [
            write_whole(part / "table.csv", partial(quantiles.map(disarm).to_csv, index=False)),
            write_whole(part / "sensitivity.csv", partial(sensitivities.map(disarm).to_csv, index=False)),
            write_sweep_report(rows, quantiles, found, exceeded, part / "report.html"),
        ],
    )
    return SweepReport(state_importance(found, rows), exceeded, found, paths)


def encode_report(report: SweepReport) -> dict[str, object]:
    """Return what `--json` prints of a report."""
    return {
        "sentence": report.sentence,
        "exceeded": [row._asdict() for row in report.exceeded],
        "sensitivities": [row._asdict() for row in report.sensitivities.rows],
    }
