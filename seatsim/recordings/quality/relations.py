"""What channels of a seat or a bench show of each other: signs and units that no law of motion permits.

Nothing of the rig is needed: accelerations contradict the travel, a damper's force does work on the motion, a channel
that follows another one does so with the wrong sign or size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from seatsim.recordings.quality.issue import Issue
from seatsim.schema.units import USUAL, find_conversion

Array = NDArray[np.float64]

ALIKE = 0.9
"""Correlation from which a factor between two sides of an equation is meant."""
MOST_ROWS = 120_000
"""Rows from which relations are computed."""
TINY_FORCE, MOVED = 5.0, 1e-3
"""N that a damper exceeds once it is moved by so many m."""
UNEXPLAINED = 0.2
"""Share of the travel's second derivative that both accelerations leave, above which they are no balance."""
SURELY_ALIKE, FAR = 0.97, 0.3
"""Correlation of a coil with its command, and share by which a factor differs from one, that no effect gives."""
NEAR = 0.25
"""Share by which a factor may differ from that of a unit."""


def doubt_relations(table: Mapping[str, Array], rate: float) -> Iterator[Issue]:
    """Yield signs and units of a seat's or a bench's channels that contradict the laws of motion, whatever the rig."""
    part = {name: values[:MOST_ROWS] - float(np.mean(values[:MOST_ROWS])) for name, values in table.items()}
    yield from _force(part, rate)
    yield from _motion(part, rate)
    # On a stiff cushion the driver moves as the frame does, and a coil follows its command.
    yield from _copies(part, rate, ("frame_acceleration", "driver_acceleration", "m/s^2"), (0.5, 2.0))
    yield from _copies(part, rate, ("current_command", "coil_current", "A"), (0.0, 2.0))


def _copies(
    part: Mapping[str, Array], rate: float, named: tuple[str, str, str], band: tuple[float, float]
) -> Iterator[Issue]:
    """Yield what it means that a channel is another one in a band, but for its sign or its unit."""
    first, second, unit = named
    if first in part and second in part:
        gain, alike = regress(part[first], part[second], rate, *band)
        if alike > ALIKE and (said := read_gain(gain, unit)):
            text = f"{second}: is {gain:.3g} times {first} below {band[1]:g} Hz: {said}, or that of {first} is wrong"
            yield Issue("warning", kind_of(gain), text, second)
        elif unit == "A" and alike > SURELY_ALIKE and gain > 1.0 + FAR:
            text = f"{second}: is {gain:.3g} times {first} below {band[1]:g} Hz; the scale of one of both is wrong"
            yield Issue("warning", "scale", text, second)


def kind_of(gain: float) -> str:
    """Return the kind of the issue that a gain is."""
    return "sign" if gain < 0.0 else "unit"


def _force(part: Mapping[str, Array], rate: float) -> Iterator[Issue]:
    """Yield a damper force that drives the motion, where it opposes extension and dissipates, or that is tiny."""
    name = "displacement" if "displacement" in part else "suspension_displacement"
    if name not in part or "damper_force" not in part:
        return
    travel, force = part[name], part["damper_force"]
    largest, stroke = float(np.max(np.abs(force))), float(np.max(np.abs(travel)))
    if largest < TINY_FORCE and stroke > MOVED:
        text = f"damper_force: is {largest:.3g} N at most over a stroke of {1e3 * stroke:.3g} mm; is it in kN?"
        yield Issue("warning", "unit", text, "damper_force")
    speed = np.gradient(travel, 1.0 / rate)
    gain, alike = regress(speed, force, rate, 0.05)
    if alike > 0.3 and gain < 0.0:
        text = "damper_force: does work on the motion instead of taking it out: its sign is swapped, or that of " + name
        yield Issue("warning", "sign", text, "damper_force")


def _motion(part: Mapping[str, Array], rate: float) -> Iterator[Issue]:
    """Compare the travel's second derivative with frame - floor acceleration, the shares of both apart.

    No effect on a rig does what a swapped sign or a wrong unit does here: it is an error.
    """
    if not {"suspension_displacement", "frame_acceleration", "floor_acceleration"} <= set(part):
        return
    slope = np.gradient(np.gradient(part["suspension_displacement"], 1.0 / rate), 1.0 / rate)
    target, frame, floor = (
        band_passed(each, rate, 0.7, min(8.0, 0.2 * rate))
        for each in (slope, part["frame_acceleration"], part["floor_acceleration"])
    )
    shares, left, _, _ = np.linalg.lstsq(np.column_stack([frame, -floor]), target, rcond=None)
    if not len(left) or left[0] > UNEXPLAINED * float(target @ target) or not shares.all():
        return
    gains = {"frame_acceleration": 1.0 / float(shares[0]), "floor_acceleration": 1.0 / float(shares[1])}
    both = float(np.mean(list(gains.values())))
    if abs(gains["frame_acceleration"] / gains["floor_acceleration"] - 1.0) < NEAR:
        yield from _motion_of_both(both, rate)
        return
    for name, gain in gains.items():
        if said := read_gain(gain, "m/s^2"):
            text = f"{name}: is {gain:.3g} times what the travel and the other acceleration show: {said}"
            yield Issue("error", kind_of(gain), text, name)


def _motion_of_both(gain: float, rate: float) -> Iterator[Issue]:
    """Yield what it means that both accelerations differ from the travel's by the same factor."""
    if said := read_gain(gain, "m/s^2"):
        exchanged = ", or the two are exchanged" if gain < 0.0 else ""
        text = f"are {gain:.3g} times the travel's second derivative: of both {said}{exchanged}"
        first = "floor_acceleration"
        yield Issue("error", kind_of(gain), f"{first} and frame_acceleration: {text}", first)
    if said := read_gain(1.0 / gain, "m"):
        text = f"its second derivative is {1.0 / gain:.4g} times frame - floor acceleration: {said}"
        yield Issue("error", kind_of(gain), f"suspension_displacement: {text}", "suspension_displacement")
    elif gain > 0.0 and not 1.0 - FAR < gain < 1.0 / (1.0 - FAR):
        text = f"its second derivative is {1.0 / gain:.3g} times frame - floor acceleration: its scale is wrong by that"
        other = f", or the sample rate, which then is {rate * gain**0.5:.4g} Hz"
        yield Issue("warning", "scale", f"suspension_displacement: {text}{other}", "suspension_displacement")


def band_passed(values: Array, rate: float, low: float, high: float) -> Array:
    """Return values between two frequencies in Hz, by smooth edges in the frequency domain."""
    spectrum = np.fft.rfft(values * np.hanning(len(values)))
    frequency = np.fft.rfftfreq(len(values), 1.0 / rate)
    with np.errstate(divide="ignore"):
        edges = 1.0 / (1.0 + (frequency / high) ** 8) / (1.0 + (low / np.maximum(frequency, 1e-12)) ** 8)
    return np.fft.irfft(spectrum * edges, len(values))


def regress(expected: Array, measured: Array, rate: float, low: float = 0.5, high: float = 8.0) -> tuple[float, float]:
    """Return the gain of measured to expected between two frequencies, and their correlation without its sign."""
    high = min(high, 0.2 * rate)
    one, other = band_passed(expected, rate, low, high), band_passed(measured, rate, low, high)
    norm = float(np.linalg.norm(one) * np.linalg.norm(other))
    product = float(one @ other)
    return (product / float(one @ one), abs(product) / norm) if norm else (0.0, 0.0)


def read_gain(gain: float, unit: str) -> str:
    """Return what a gain of values in a unit means; empty where it is close to one, or means nothing."""
    sign = "its sign is swapped" if gain < 0.0 else ""
    if abs(abs(gain) - 1.0) < NEAR:
        return sign
    for other in USUAL[unit]:
        found = find_conversion(other, unit)
        if found is not None and abs(abs(gain) * found.factor - 1.0) < NEAR:
            return f"it reads as if in {other}" + (f", and {sign}" if sign else "")
    return sign
