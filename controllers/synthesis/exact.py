"""Matrices without rounding: doubles are whole numbers over powers of two, and so are their sums and products."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.synthesis.plant import GeneralisedPlant
from seatsim.schema.arrays import Array


@dataclass(frozen=True, eq=False)
class ExactMatrix:
    """The matrix `whole / 2^bits`, `whole` an array of Python's integers; `@`, `+`, `-` and `.T` are exact."""

    whole: NDArray[np.object_]
    bits: int

    @classmethod
    def of(cls, matrix: Array) -> ExactMatrix:
        """Return a matrix of doubles as it is."""
        ratios = [[value.as_integer_ratio() for value in row] for row in matrix.tolist()]
        bits = max((bottom.bit_length() - 1 for row in ratios for _, bottom in row), default=0)
        whole = np.empty(matrix.shape, dtype=object)
        for i, row in enumerate(ratios):
            for j, (top, bottom) in enumerate(row):
                whole[i, j] = top << (bits - bottom.bit_length() + 1)
        return cls(whole, bits)

    def __matmul__(self, other: ExactMatrix) -> ExactMatrix:
        # Python's integers grow as they must: numpy multiplies and adds them as objects, without overflow.
        return ExactMatrix(self.whole @ other.whole, self.bits + other.bits)

    def __add__(self, other: ExactMatrix) -> ExactMatrix:
        bits = max(self.bits, other.bits)
        return ExactMatrix(self.whole * 2 ** (bits - self.bits) + other.whole * 2 ** (bits - other.bits), bits)

    def __sub__(self, other: ExactMatrix) -> ExactMatrix:
        return self + ExactMatrix(-other.whole, other.bits)

    @property
    def T(self) -> ExactMatrix:  # noqa: N802 - as in NumPy
        """The transposed matrix."""
        return ExactMatrix(self.whole.T, self.bits)

    def rounded(self) -> Array:
        """Return the nearest doubles."""
        bottom = 1 << self.bits
        return np.array([[top / bottom for top in row] for row in self.whole.tolist()], dtype=float)


def close_exactly(plant: GeneralisedPlant, gain: Array) -> tuple[ExactMatrix, ExactMatrix, ExactMatrix, ExactMatrix]:
    """Return A, B, C, D of the closed loop as `GeneralisedPlant.close` does, without rounding."""
    A, B1, B2, C1, C2, D11, D12, D21 = (
        ExactMatrix.of(m) for m in (plant.A, plant.B1, plant.B2, plant.C1, plant.C2, plant.D11, plant.D12, plant.D21)
    )
    left, right = B2 @ ExactMatrix.of(gain), D12 @ ExactMatrix.of(gain)
    return A + left @ C2, B1 + left @ D21, C1 + right @ C2, D11 + right @ D21
