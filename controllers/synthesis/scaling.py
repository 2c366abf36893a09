"""Scaled coordinates, in which synthesis works: LMIs and searches fail in raw SI units.

    x = diag(states) x~,  u = diag(controls) u~,  y~ = diag(measured) y,  t~ = rate t,
    K = diag(controls) K~ diag(measured)

All factors are powers of two, so that scaling costs no rounding. w and z are left alone: gamma is the same number.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from controllers.synthesis.plant import GeneralisedPlant, LinearSystem
from seatsim.schema.arrays import Array

# Steps are powers of two, so that sweeps end where no factor changes; a guard where they circle.
_SWEEPS = 30


class ScaledPlant(NamedTuple):
    """A plant in scaled coordinates, and the way back."""

    plant: GeneralisedPlant
    controls: Array
    measured: Array
    rate: float

    def physical_gain(self, gain: Array) -> Array:
        """Gain in the user's units from the gain in scaled coordinates."""
        return self.controls[:, None] * gain * self.measured

    def scaled_gain(self, gain: Array) -> Array:
        """Gain in scaled coordinates from the gain in the user's units."""
        return gain / (self.controls[:, None] * self.measured)


def scale(plant: GeneralisedPlant, like: ScaledPlant | None = None) -> ScaledPlant:
    """Balance states against each other, B1 against C1, time against the poles; unit columns in B2, unit rows in C2.

    Units of control, measurement and time are those of `like` where it is given.
    """
    rate = like.rate if like else _power_of_two(_mean_rate(plant.A))
    states = np.ones(plant.order)
    for _ in range(_SWEEPS):
        step = _balancing_step(plant, states, rate)
        states = states * step
        if np.all(step == 1.0):
            break
    states = states * _power_of_two(np.sqrt(_size(plant.B1 / states[:, None] / rate) / _size(plant.C1 * states)))
    controls, measured = (like.controls, like.measured) if like else _input_output(plant, states, rate)
    nw, nz = plant.B1.shape[1], len(plant.C1)
    A, B, C, D = plant.system
    inputs, outputs = np.append(np.ones(nw), controls), np.append(np.ones(nz), measured)[:, None]
    flow, drive = A * states / states[:, None] / rate, B * inputs / states[:, None] / rate
    moved = LinearSystem(flow, drive, C * states * outputs, D * inputs * outputs)
    return ScaledPlant(GeneralisedPlant.from_system(moved, nw, nz, plant.structure), controls, measured, rate)


def _input_output(plant: GeneralisedPlant, states: Array, rate: float) -> tuple[Array, Array]:
    """Factors that give about unit length to the columns of B2 and the rows of C2."""
    return 1 / _sizes(plant.B2 / states[:, None] / rate), 1 / _sizes((plant.C2 * states).T)


def _balancing_step(plant: GeneralisedPlant, states: Array, rate: float) -> Array:
    """Factors that make the row and the column of every state in [A B; C 0] about equally large (Osborne)."""
    controls, measured = _input_output(plant, states, rate)
    A = np.abs(plant.A - np.diag(np.diag(plant.A))) * states / states[:, None] / rate
    B1, C1 = plant.B1 / states[:, None], plant.C1 * states
    rows = np.hstack([A, B1 / _size(B1), plant.B2 * controls / states[:, None] / rate])
    columns = np.vstack([A, C1 / _size(C1), plant.C2 * states * measured[:, None]])
    r, c = np.linalg.norm(rows, axis=1), np.linalg.norm(columns, axis=0)
    ratio = np.divide(r, c, out=np.ones_like(r), where=(r > 0) & (c > 0))
    # A quarter of the exponent at a time: all states move at once, and full steps would overshoot.
    return np.asarray(np.exp2(np.round(np.log2(ratio) / 4)))


def _mean_rate(A: Array) -> float:
    """Return the geometric mean of the poles' magnitudes in 1/s, without integrators; 1 where there is no other."""
    rates = np.abs(np.linalg.eigvals(A))
    moving = rates[rates > 1e-9 * max(rates.max(), 1e-300)]
    return float(np.exp(np.log(moving).mean())) if moving.size else 1.0


def _size(matrix: Array) -> float:
    return float(np.linalg.norm(matrix)) or 1.0


def _sizes(columns: Array) -> Array:
    norms = np.linalg.norm(columns, axis=0)
    return np.array([_power_of_two(norm) if norm > 0 else 1.0 for norm in norms])


def _power_of_two(value: float) -> float:
    return float(np.exp2(np.round(np.log2(value))))
