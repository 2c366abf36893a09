"""Motions with their first two time derivatives, so that products and fades stay consistent."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seatsim.excitations.base import Floor
from seatsim.schema.arrays import Array
from seatsim.schema.bounds import check_steps
from seatsim.schema.errors import InputError

SOFT_START = 1.0


class Motion(NamedTuple):
    """A function of time with its first and second derivative, each of shape (N,)."""

    displacement: Array
    velocity: Array
    acceleration: Array


def product(a: Motion, b: Motion) -> Motion:
    """Return `a*b` by the product rule: `(ab)'' = a''b + 2a'b' + ab''`."""
    return Motion(
        a.displacement * b.displacement,
        a.velocity * b.displacement + a.displacement * b.velocity,
        a.acceleration * b.displacement + 2 * a.velocity * b.velocity + a.displacement * b.acceleration,
    )


def sine(phase: Motion) -> Motion:
    """Return `sin(phase)` for a phase in rad that is given with its derivatives."""
    s, c = np.sin(phase.displacement), np.cos(phase.displacement)
    return Motion(s, c * phase.velocity, c * phase.acceleration - s * phase.velocity**2)


def ease(time: Array, rise: float | Array) -> Motion:
    """Return the smooth step `w = 10u^3 - 15u^4 + 6u^5`, `u = time/rise`: 0 before 0, 1 after `rise` seconds.

    `w`, `w'` and `w''` are continuous, hence a motion times `w` starts at rest without a jump of
    acceleration.
    """
    u = np.clip(time / rise, 0.0, 1.0)
    left = 1.0 - u
    return Motion(
        u**3 * (10.0 - 15.0 * u + 6.0 * u**2),
        30.0 * (u * left) ** 2 / rise,
        60.0 * u * left * (left - u) / np.square(rise),
    )


def soft_start(step: float, motion: Motion) -> Floor:
    """Return the floor that follows `motion`, faded in by `ease` from rest over the first second.

    Runs shorter than four seconds are faded in over their first quarter.
    """
    time = clock(len(motion.displacement), step)
    return floor_of(step, product(ease(time, min(SOFT_START, time[-1] / 4)), motion))


def floor_of(step: float, motion: Motion) -> Floor:
    """Return `motion` as a floor sampled every `step` seconds."""
    return Floor(step, motion.acceleration, motion.velocity, motion.displacement)


def clock(count: int, step: float) -> Array:
    """Return the times `0, step, ...` in s, shape (count,)."""
    return step * np.arange(count, dtype=np.float64)


def samples(duration: float, step: float) -> int:
    """Return `round(duration/step) + 1`, the number of samples of a run from 0 to `duration`, both included.

    Raises:
        InputError: the run is shorter than two steps, or does not fit into the memory.
    """
    check_steps(duration / step)
    count = round(duration / step) + 1
    if count < 3:
        raise InputError(f"duration {duration:g} s holds fewer than two steps of {step:g} s; lengthen it")
    return count


def check_step(kind: str, step: float, highest: float, per_period: int) -> None:
    """Refuse a `step` with fewer than `per_period` samples in a period of the `highest` frequency in Hz.

    The simulation interpolates the acceleration linearly, which scales a tone of `p` samples a period by
    `sinc(1/p)^2`: 0.97 at 10, required of pure tones, and 0.87 at 5, required of the upper end of a broad band,
    which carries little power.

    Raises:
        InputError: the step is too coarse.
    """
    permitted = 1.0 / (per_period * highest)
    if step > permitted * (1 + 1e-9):
        raise InputError(
            f"excitation '{kind}': a step of {step:g} s is too coarse for its {highest:.4g} Hz; "
            f"permitted: at most {permitted:.3g} s; lower solver.step"
        )
