"""Parquet files of others, opened once what they state has been counted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from seatsim.schema.bounds import check_made

if TYPE_CHECKING:
    from pyarrow.parquet import ParquetFile

BYTES_OF_NUMBER = 8


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
    numbers = BYTES_OF_NUMBER * stated.num_rows * stated.num_columns
    check_made(max(packed, numbers), len(content), "what its columns state")
    return file
