"""Recordings of rigs that nobody here built, and what the diagnosis says of them: `python benchmarks/real_rigs.py`.

Out of `../shared/data` are written into `--out` folders
`NAME`, `NAME-fit` (the records that the nominal was fitted to) and `NAME-unseen`, all with the same nominal: a plain
model without what the data are known to show. `rig_records` says what they are.
"""

from __future__ import annotations

import argparse
import time
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from carrier_nominals import DATA, fit, quick, require_data, write_part
from rig_records import RigRecords, list_rigs
from ruamel.yaml import YAML

import seatsim
from seatsim.recordings.recording import load_recording
from seatsim.recordings.replay import LEFT_OUT
from seatsim.schema.files import write_whole

TOLERANCE = 0.1
"""Fits to single records scatter by 8-20 % in the leading parameters of the nominals, by more in the others."""


def write(rig: RigRecords, folder: Path) -> Path:
    """Write a rig's three folders with a nominal fitted to the first, and return that of the recording."""
    parts = {"-fit": rig.fit, "-unseen": rig.unseen, "": rig.runs}
    folders = {part: folder / f"{rig.name}{part}" for part, runs in parts.items() if runs}
    for part, out in folders.items():
        write_part(rig, rig.nominal, parts[part], out, TOLERANCE)
    recording, skip = quick(load_recording(folders["-fit"])), round(LEFT_OUT * rig.sample_rate)
    counted = np.concatenate([rig.counted(recording.table(run))[skip:] for run in recording.runs])
    nominal = fit(recording, rig.nominal, rig.free, (), counted).nominal
    for out in folders.values():
        write_whole(out / "nominal.yaml", partial(YAML(typ="safe").dump, nominal))
    return folders[""]


def main() -> None:
    """Write the recordings, diagnose them, and print the table."""
    parser = argparse.ArgumentParser(description="recordings of real rigs, and what the diagnosis says of them")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--out", type=Path, required=True, help="folder for the recordings")
    parser.add_argument("--only", nargs="*", metavar="RIG", help="names of rigs")
    options = parser.parse_args()
    rows = []
    for rig in list_rigs(require_data(options.data)):
        if options.only and rig.name not in options.only:
            continue
        folder, start = write(rig, options.out), time.perf_counter()
        gap, found = seatsim.gap(folder / "nominal.yaml", folder), seatsim.diagnose(folder)
        where = ", ".join(f"{share.block} {share.share:.2f}" for share in found.where)
        cells = f"{gap.overall:.3f}", found.verdict, ", ".join(found.selected), where, f"{found.gap.shrink:.2f}"
        rows.append((rig.name, *cells, f"{time.perf_counter() - start:.0f}", rig.known))
    headings = ["rig", "gap", "verdict", "selected", "where", "shrink", "s", "known to show"]
    print(pd.DataFrame(rows, columns=headings).to_string(index=False))


if __name__ == "__main__":
    main()
