"""The rows of a sweep as a frame."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seatsim.schema.errors import InputError
from seatsim.sweeps.manifest import read_manifest
from seatsim.sweeps.parts import read_part

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa


def read_sweep(folder: str | Path) -> pd.DataFrame:
    """Return the rows of a sweep so far, one for each run that has ended, by number.

    Columns are `run`, `state` (done, failed, unverified), `reason`, `seed`, every varied key and every metric in SI
    units; a figure that does not exist is NaN, as are all of a failed run. `frame.attrs["units"]` holds units.

    Raises:
        InputError: the folder holds no sweep, or none of its runs has ended.
    """
    import pyarrow as pa

    folder = Path(folder)
    read_manifest(folder)
    parts = sorted(folder.glob("runs/part-*.parquet"))
    if not parts:
        raise InputError(f"{folder}: no run of this sweep has ended; go on with it with --resume")
    tables = [read_part(part) for part in parts]
    try:
        table = pa.concat_tables(tables)
    except pa.ArrowInvalid as error:
        raise InputError(f"{folder}: holds parts of different sweeps: {error}; choose another folder") from error
    frame: pd.DataFrame = table.to_pandas()
    frame.attrs["units"] = units_of(table.schema)
    return frame


def units_of(schema: pa.Schema) -> dict[str, str]:
    """Return the units of the columns that have one."""
    stated = {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in schema}
    return {name: unit for name, unit in stated.items() if unit}
