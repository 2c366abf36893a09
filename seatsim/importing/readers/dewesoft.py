"""Files of Dewesoft, DXD and D7D, read by dwdatareader, which calls the compiled library of their maker."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from seatsim.importing.readers.reading import TextLayout, need
from seatsim.importing.signals import Channels, DataFile, Signal, note_left_out
from seatsim.schema.guarded import temporary_folder

_EVEN = 0
"""Type of a channel whose samples have one distance."""
_LEFT_OUT = "channels that hold no single numbers, or are not read by dwdatareader"


def read(path: Path, content: bytes, layout: TextLayout) -> DataFile:
    """Return the channels of single numbers: those of one rate as a group, those with times of their own as others."""
    dewesoft = need("dwdatareader", "Dewesoft")
    gathered, left_out = Channels(), list[str]()
    with temporary_folder() as folder:
        copy = folder / "file.dxd"  # the library opens files, and what was unpacked is none
        copy.write_bytes(content)
        with dewesoft.DWFile(str(copy)) as file:
            for channel in file.values():
                try:
                    times, values = channel.scaled()
                except (dewesoft.DWError, AttributeError):  # of messages on a bus, and of texts
                    times, values = np.empty(0), np.empty(0)
                signal = Signal(channel.long_name, channel.unit, values)
                if not len(times) or values.shape != times.shape or values.dtype.kind != "f":
                    left_out.append(signal.name)
                elif channel.channel_type == _EVEN:
                    gathered.add(path.stem, signal, channel.sample_rate, float(times[0]))
                else:
                    gathered.add_timed(path.stem, times, [signal])
    return DataFile(path, "", gathered.groups(), note_left_out(_LEFT_OUT, left_out))
