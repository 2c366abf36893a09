"""The array that signals, matrices and tables are held in, as own code gives it and as columns of Parquet files.

Parquet files of others are opened once what they state has been counted. The conversion of pyarrow itself imports
pandas, which takes longer than the writing.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatsim.schema.bounds import check_made
from seatsim.schema.errors import RunError

if TYPE_CHECKING:
    import pyarrow as pa
    from pyarrow.parquet import ParquetFile


Array = NDArray[np.float64]


def require_samples(values: object, giver: str, count: int, step: float) -> Array:
    """Return samples as an array of float64 and shape (count,), taken every `step` seconds.

    Raises:
        RunError: they are no numbers, others in number, or one of them is not finite; the error begins with `giver`,
            which says whose samples they are.
    """
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RunError(f"{giver} gives {type(values).__name__}, not an array of numbers") from error
    if found.shape != (count,):
        raise RunError(f"{giver} gives an array of shape {found.shape}; it must be of shape ({count},)")
    bad = np.flatnonzero(~np.isfinite(found))
    if bad.size:
        raise RunError(f"{giver} gives {found[bad[0]]} at sample {bad[0]}, {bad[0] * step:.6g} s; it must be finite")
    return found


_BYTES_OF_NUMBER = 8


def open_parquet(content: bytes) -> ParquetFile:
    """Return a Parquet file whose columns are no larger than one of its size may make.

    Raises:
        TooMuchError: they are larger. ArrowException, OSError: it is no Parquet file.
    """
    import pyarrow as pa
    from pyarrow.parquet import ParquetFile

    file = ParquetFile(pa.BufferReader(content))
    stated = file.metadata
    packed = sum(stated.row_group(index).total_byte_size for index in range(stated.num_row_groups))
    numbers = _BYTES_OF_NUMBER * stated.num_rows * stated.num_columns
    check_made(max(packed, numbers), len(content), "what its columns state")
    return file


def store_numbers(values: NDArray[np.generic], kind: pa.DataType, present: NDArray[np.bool_] | None = None) -> pa.Array:
    """Return numbers or truth values, shape (N,), as an array of a kind; those that are not `present` are null."""
    import pyarrow as pa

    stored = np.ascontiguousarray(values, dtype=kind.to_pandas_dtype())
    content = np.packbits(stored, bitorder="little") if pa.types.is_boolean(kind) else stored
    known = None if present is None or present.all() else pa.py_buffer(np.packbits(present, bitorder="little"))
    return pa.Array.from_buffers(kind, len(stored), [known, pa.py_buffer(content)])


def store_texts(texts: Sequence[str]) -> pa.Array:
    """Return texts as an array."""
    import pyarrow as pa

    encoded = [text.encode() for text in texts]
    ends = np.array([0, *accumulate(map(len, encoded))], dtype=np.int32)
    buffers = [None, pa.py_buffer(ends), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(encoded), buffers)
