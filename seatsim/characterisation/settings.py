"""At which currents, temperatures, amplitudes and frequencies a model is tested."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from seatsim.characterisation.specimen import DamperSpecimen
from seatsim.schema.errors import InputError

FASTEST = (2.0, 1.0, 0.5, 0.2, 0.1)
"""Hz; the first that keeps to the model's speeds is the highest frequency where none is stated."""
LARGEST = 0.01
"""m; largest amplitude where none is stated."""
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Currents over the largest for which the model holds."""


class SweepSettings(NamedTuple):
    """Currents [A], temperatures [degC], amplitudes [m] and frequencies [Hz] of the tests."""

    currents: Sequence[float]
    temperatures: Sequence[float]
    amplitudes: Sequence[float]
    frequencies: Sequence[float]


def choose_settings(
    tested: DamperSpecimen, currents: str = "", temperatures: str = "", amplitudes: str = "", frequencies: str = ""
) -> SweepSettings:
    """Return the settings that are stated as numbers between commas, and for the others those for which a model holds.

    By default: five currents up to the largest; the least, mean and largest temperature where these matter, else the
    one at which the factors are 1; amplitudes up to 10 mm and frequencies up to 2 Hz, as far as the model's largest
    speed permits.

    Raises:
        InputError: a list is not of numbers, or one of them is out of bounds.
    """
    specification, factors = tested.specification, tested.factors
    largest = min(specification.max_current, tested.coil.max_current)
    low, high = specification.temperatures
    warm = (low, 0.5 * (low + high), high) if any(factors[:3]) and high > low else (factors.reference,)
    far = _parse_numbers("--amplitudes", amplitudes, "m", "0.005,0.01", above=0.0)
    fast = _parse_numbers("--frequencies", frequencies, "Hz", "0.5,1,2", above=0.0)
    reach = specification.max_speed / (2.0 * math.pi)
    if not far:
        largest_far = _round_down(min(LARGEST, reach / max(fast))) if fast else LARGEST
        far = [0.5 * largest_far, largest_far]
    if not fast:
        top = next((f for f in FASTEST if f * max(far) <= reach), FASTEST[-1])
        fast = [0.25 * top, 0.5 * top, top]
    return SweepSettings(
        _parse_numbers("--currents", currents, "A", "0,0.5,1", low=0.0)
        or [round(share * largest, 9) for share in SHARES],
        _parse_numbers("--temperatures", temperatures, "degC", "20,50,80", low=-50.0, high=200.0) or list(warm),
        far,
        fast,
    )


def _round_down(value: float) -> float:
    """Return a value rounded down to one digit."""
    digit = 10.0 ** math.floor(math.log10(value))
    return round(math.floor(value / digit + 1e-9) * digit, 12)


def _parse_numbers(
    option: str,
    text: str,
    unit: str,
    example: str,
    low: float = -math.inf,
    high: float = math.inf,
    above: float = -math.inf,
) -> list[float]:
    bounds = f" of at least {low:g}" if low > -math.inf else f" above {above:g}" if above > -math.inf else ""
    bounds += f" and at most {high:g}" if high < math.inf else ""
    values = []
    for part in text.split(",") if text.strip() else []:
        try:
            value = float(part)
        except ValueError:
            value = math.nan
        if not (low <= value <= high and value > above and math.isfinite(value)):
            raise InputError(
                f"{option} {text}: '{part.strip()}' is not permitted; write numbers{bounds} {unit} between commas,"
                f" such as {option} {example}"
            )
        values.append(value)
    return sorted(set(values))
