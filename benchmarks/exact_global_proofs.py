"""Proofs that no gain is better, in rational arithmetic: `python benchmarks/exact_global_proofs.py global.json ...`.

Shares no code with the synthesis. It walks through the boxes of a file that `seatsim synthesise --global` wrote and
evaluates every inequality at every corner of its box from the file's doubles as fractions. What it relies on: an
inequality that holds at all corners holds in the box (see `controllers.synthesis.exclusion`).
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import time
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
from exact_certificates import NAMES, Exact, Plain, is_positive_definite, to_fractions

Number = tuple[Fraction, Fraction]
"""Real and imaginary part; of arrays, the two arrays."""


def multiply(a: tuple[Exact, Exact], b: tuple[Exact, Exact]) -> tuple[Exact, Exact]:
    """Return the product of two complex matrices."""
    return a[0] @ b[0] - a[1] @ b[1], a[0] @ b[1] + a[1] @ b[0]


def determinant(M: Exact) -> Fraction:
    """Return the determinant of a real matrix by elimination."""
    M, result = M.copy(), Fraction(1)
    for k in range(len(M)):
        pivot = next((i for i in range(k, len(M)) if M[i, k] != 0), None)
        if pivot is None:
            return Fraction(0)
        if pivot != k:
            M[[k, pivot]], result = M[[pivot, k]], -result
        result *= M[k, k]
        M[k + 1 :, k:] -= np.outer(M[k + 1 :, k] / M[k, k], M[k, k:])
    return result


def solve(M: Exact, right: Exact) -> Exact:
    """Return the solution of M X = right by elimination with exchanges of rows."""
    n, both = len(M), np.hstack([M, right])
    for k in range(n):
        pivot = next(i for i in range(k, n) if both[i, k] != 0)
        both[[k, pivot]] = both[[pivot, k]]
        both[k] /= both[k, k]
        for i in range(n):
            if i != k:
                both[i] -= both[i, k] * both[k]
    solution: Exact = both[:, n:]
    return solution


class Plant:
    """A generalised plant in fractions."""

    def __init__(self, plain: Plain) -> None:
        self.A, self.B1, self.B2, self.C1, self.C2, self.D11, self.D12, self.D21 = (
            to_fractions(plain[name]) for name in NAMES
        )
        self.free = np.array(plain["free"], dtype=bool)
        self.respond = cache(self._respond)

    def gain(self, corner: tuple[Fraction, ...]) -> Exact:
        """Return the gain of values of the free entries."""
        K = np.full(self.free.shape, Fraction(0), dtype=object)
        K[self.free] = corner
        return K

    def close(self, corner: tuple[Fraction, ...]) -> Exact:
        """Return A of the closed loop."""
        closed: Exact = self.A + self.B2 @ self.gain(corner) @ self.C2
        return closed

    def _respond(self, s: Number | None) -> list[tuple[Exact, Exact]]:
        """Return P11, P12, P21, P22 at s; None is infinity."""
        n, B, C = len(self.A), np.hstack([self.B1, self.B2]), np.vstack([self.C1, self.C2])
        corner = np.full((len(self.C2), self.B2.shape[1]), Fraction(0), dtype=object)
        real, imaginary = np.block([[self.D11, self.D12], [self.D21, corner]]), 0 * C @ B
        if s is not None:
            identity = np.array([[Fraction(int(i == j)) for j in range(n)] for i in range(n)], dtype=object)
            M = np.block([[s[0] * identity - self.A, -s[1] * identity], [s[1] * identity, s[0] * identity - self.A]])
            X = solve(M, np.vstack([B, 0 * B]))
            real, imaginary = real + C @ X[:n], imaginary + C @ X[n:]
        z, w = len(self.C1), self.B1.shape[1]
        rows, columns = (slice(z), slice(z, None)), (slice(w), slice(w, None))
        return [(real[part], imaginary[part]) for part in itertools.product(rows, columns)]


def complex_determinant(M: tuple[Exact, Exact]) -> Number:
    """Return the determinant of a complex matrix by expansion; it has few rows."""
    if len(M[0]) == 0:
        return Fraction(1), Fraction(0)
    total = Fraction(0), Fraction(0)
    for j in range(len(M[0])):
        rest = [np.delete(np.delete(part, 0, axis=0), j, axis=1) for part in M]
        d, (a, b), sign = complex_determinant((rest[0], rest[1])), (M[0][0, j], M[1][0, j]), (-1) ** j
        total = total[0] + sign * (a * d[0] - b * d[1]), total[1] + sign * (a * d[1] + b * d[0])
    return total


def adjugate(M: tuple[Exact, Exact]) -> tuple[Exact, Exact]:
    """Return the adjugate of a complex matrix by its minors."""
    n = len(M[0])
    real, imaginary = np.empty((n, n), dtype=object), np.empty((n, n), dtype=object)
    for i, j in itertools.product(range(n), repeat=2):
        minor = [np.delete(np.delete(part, j, axis=0), i, axis=1) for part in M]
        d = complex_determinant((minor[0], minor[1]))
        real[i, j], imaginary[i, j] = (-1) ** (i + j) * d[0], (-1) ** (i + j) * d[1]
    return real, imaginary


def root_above(value: Fraction) -> Fraction:
    """Return a fraction not below the square root, close to it."""
    scale = 1 << max(0, 200 - (value.numerator.bit_length() - value.denominator.bit_length()) // 2)
    return Fraction(math.isqrt(value.numerator * scale * scale // value.denominator) + 1, scale)


def evaluate(plant: Plant, inequality: Plain, corner: tuple[Fraction, ...], level: Fraction | None) -> Fraction:
    """Return a number not above the function of an inequality at a corner; without a level none of a norm counts."""
    if "power" in inequality:
        return -coefficient(plant.close(corner), inequality["power"])
    if level is None:
        raise SystemExit("that no gain is stable is concluded from a norm, for which the proof has no level")
    s = None if inequality["s"] is None else (Fraction(inequality["s"][0]), Fraction(inequality["s"][1]))
    if s is not None and s[0] < 0:
        raise SystemExit("a point lies left of the imaginary axis")
    P11, P12, P21, P22 = plant.respond(s)
    K, zero = plant.gain(corner), Fraction(0)
    identity = np.array([[Fraction(int(i == j)) for j in range(len(K))] for i in range(len(K))], dtype=object)
    L = identity - K @ P22[0], -(K @ P22[1])
    d = complex_determinant(L)
    added = multiply(multiply(P12, adjugate(L)), (K @ P21[0], K @ P21[1]))
    N = d[0] * P11[0] - d[1] * P11[1] + added[0], d[0] * P11[1] + d[1] * P11[0] + added[1]
    p, q = (
        tuple(np.array([Fraction(z[part]) for z in inequality[name]], dtype=object) for part in (0, 1)) for name in "pq"
    )
    real, imaginary = multiply(N, (q[0][:, None], q[1][:, None]))
    along: Fraction = p[0] @ real[:, 0] + p[1] @ imaginary[:, 0]
    squares = [sum((x * x for x in (*v[0], *v[1])), zero) for v in (p, q)]
    return along - level * root_above((d[0] ** 2 + d[1] ** 2) * squares[0] * squares[1])


def coefficient(A: Exact, power: int) -> Fraction:
    """Return the coefficient of s^power of the characteristic polynomial: a sum of principal minors."""
    n = len(A)
    chosen = itertools.combinations(range(n), n - power)
    return sum(((-1) ** (n - power) * determinant(A[np.ix_(rows, rows)]) for rows in chosen), Fraction(0))


def is_excluded(plants: list[Plant], step: Plain, corners: list[tuple[Fraction, ...]], level: Fraction | None) -> bool:
    """Whether a step excludes the box with these corners."""
    if "X" in step:
        plant, X, shift = plants[step["plant"]], to_fractions(step["X"]), Fraction(step["shift"])
        loops = [plant.close(corner) - shift * np.eye(len(X), dtype=int) for corner in corners]
        falls = all(is_positive_definite(-(F.T @ X + X @ F)) for F in loops)
        return shift >= 0 and falls and not is_positive_semidefinite(X)
    named = [(Fraction(one["weight"]), plants[one["plant"]], one) for one in step["inequalities"]]
    if min(weight for weight, *_ in named) <= 0:
        return False
    return all(sum(w * evaluate(plant, one, corner, level) for w, plant, one in named) >= 0 for corner in corners)


def is_positive_semidefinite(M: Exact) -> bool:
    """Whether all principal minors of a symmetric matrix are at least zero."""
    return all(coefficient(-M, power) >= 0 for power in range(len(M)))


def check(path: Path) -> str:
    """Return what the proof in a file is worth, in words."""
    plain = json.loads(path.read_text())
    plants = [Plant(one) for one in plain["plants"]]
    level = None if plain["level"] is None else Fraction(plain["level"])
    waiting = [([Fraction(x) for x in plain["low"]], [Fraction(x) for x in plain["high"]])]
    boxes = 0
    for step in plain["steps"]:
        low, high = waiting.pop()
        if "at" in step:
            gain, at = step["gain"], Fraction(step["at"])
            if not low[gain] <= at <= high[gain]:
                return f"REFUTED: step {boxes} divides a box outside it"
            waiting.append(([*low[:gain], at, *low[gain + 1 :]], high))
            waiting.append((low, [*high[:gain], at, *high[gain + 1 :]]))
            continue
        boxes += 1
        corners = list(itertools.product(*zip(low, high, strict=True)))
        if not is_excluded(plants, step, corners, level):
            return f"REFUTED: box {boxes} from {list(map(float, low))} to {list(map(float, high))} is not excluded"
    return f"REFUTED: {len(waiting)} boxes have no reason" if waiting else f"proven in {boxes} boxes"


def main() -> None:
    """Print a line for every proof."""
    parser = argparse.ArgumentParser(description="check proofs that no gain is better in fractions")
    parser.add_argument("proofs", nargs="+", type=Path, help="a `global.json` of `seatsim synthesise --global`")
    for path in parser.parse_args().proofs:
        begin = time.process_time()
        print(f"{path}: {check(path)} in {time.process_time() - begin:.1f} s", flush=True)


if __name__ == "__main__":
    main()
