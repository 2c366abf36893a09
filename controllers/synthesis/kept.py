"""Gains that were found before, kept beside the compiled runs: a search takes seconds, and the same seat comes again.

A gain is kept under the sources of the synthesis and the matrices of its plants, so that a change of either is searched
anew. What is known of a gain, its norm and the proof of it, is not kept: that is worked out whenever it is used.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from controllers.synthesis.plant import MATRICES, GeneralisedPlant
from seatsim.compilation.cached import find_folder
from seatsim.schema.arrays import Array
from seatsim.schema.errors import SeatsimError
from seatsim.schema.files import write_whole

_SOURCES = b"".join(file.read_bytes() for file in sorted(Path(__file__).parent.glob("*.py")))
"""Sources of the synthesis, as they are when it is loaded."""


def find_kept(plants: Sequence[GeneralisedPlant], find: Callable[[], Array]) -> Array:
    """Return the gain (nu, ny) that `find` found for these plants before, or finds now.

    A file that is damaged counts as none; where the cache cannot be written, nothing is kept.
    """
    folder = find_folder("gains")
    if folder is None:
        return find()
    state = hashlib.sha256(_SOURCES)
    for plant in plants:
        for matrix in (*(getattr(plant, name) for name in MATRICES), plant.free):
            state.update(repr(matrix.shape).encode() + matrix.tobytes())
    file = folder / f"{state.hexdigest()}.json"
    try:
        kept = np.array(json.loads(file.read_bytes()), dtype=np.float64)
        if kept.shape == plants[0].free.shape and np.isfinite(kept).all():
            return kept
    except (OSError, ValueError, TypeError):
        pass
    gain = find()
    with suppress(SeatsimError):
        write_whole(file, lambda part: part.write_text(json.dumps(gain.tolist())))
    return gain
