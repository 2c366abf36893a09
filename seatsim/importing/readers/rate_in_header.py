"""The sample rate that lines above a text table state, such as `SampleRate, 200, Hz` or `dt = 0.002 s`."""

from __future__ import annotations

import re
from collections.abc import Sequence

ENTRY = re.compile(
    r"""^[\W_]*(?P<key>[^\W\d][^\d:=;,|\t\[(]*?)["']?\s*(?:[\[(](?P<of_key>[^\])]*)[\])])?\s*[:=;,|\t ]\s*["']?"""
    r"""(?P<number>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)["']?[\s;,|\[(]*(?P<unit>[A-Za-zµμ]*)[\W_]*$"""
)
"""A key, a number and perhaps a unit, in a line of their own."""
LONGEST = 200
"""Letters of a line that may be such an entry."""
SAMPLE = r"(?:sampl\w*|abtast|scan|acquisition)[ _]*"
RATE = re.compile(rf"{SAMPLE}(?:rate|freq\w*)|fs|samplerate|fr[ée]quence d.[ée]chantillonnage", re.IGNORECASE)
STEP = re.compile(rf"{SAMPLE}(?:interval\w*|period\w*|step|zeit)|dt|delta[ _]?[tx]", re.IGNORECASE)
IN_HZ = {"": 1.0, "hz": 1.0, "khz": 1e3, "s": 1.0, "sps": 1.0}
IN_S = {"": 1.0, "s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6}


def find_rate(lines: Sequence[str]) -> float | None:
    """Return the sample rate in Hz that lines state, None where none does."""
    entries = (ENTRY.match(line) for line in lines if len(line) <= LONGEST)
    for entry in filter(None, entries):
        number = float(entry["number"].replace(",", "."))
        unit = (entry["unit"] or entry["of_key"] or "").lower()
        key = entry["key"].strip()
        if RATE.fullmatch(key) and number > 0.0 and unit in IN_HZ:
            return number * IN_HZ[unit]
        if STEP.fullmatch(key) and number > 0.0 and unit in IN_S:
            return 1.0 / (number * IN_S[unit])
    return None
