"""Numbers and texts as pyarrow holds them. Its own conversion imports pandas, which takes longer than the writing."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow as pa


def store_numbers(values: NDArray[Any], kind: pa.DataType, present: NDArray[np.bool_] | None = None) -> pa.Array:
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
