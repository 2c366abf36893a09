"""Channels as SEP 005 of the SDyPy project states them, in a JSON list, checked by sdypy-sep005."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Signal


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels; a start without times is counted in s from the earliest that a channel states."""
    check = need("sdypy_sep005", "SEP 005").Sep005Data.model_validate
    channels = []
    for number, stated in enumerate(json.loads(content), 1):
        try:
            channels.append(check(stated))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise ValueError(": ".join([f"channel {number}", *map(str, first["loc"][:1]), first["msg"]])) from error
    starts = [_start(channel.start_timestamp) for channel in channels]
    earliest = min((start for start in starts if start is not None), default=0.0)
    gathered = Channels()
    for channel, start in zip(channels, starts, strict=True):
        group = channel.group or path.stem
        signal = Signal(channel.name, channel.unit_str, np.asarray(channel.data, dtype=np.float64))
        if channel.time is not None:
            gathered.add_timed(group, np.asarray(channel.time), [signal])
        else:
            gathered.add(group, signal, channel.fs, None if start is None else start - earliest)
    return DataFile(path, "", gathered.groups())


def _start(stamp: str | None) -> float | None:
    return datetime.fromisoformat(stamp).timestamp() if stamp else None
