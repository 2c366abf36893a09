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
from exact_certificates import NAMES, Exact, Plain, to_fractions

Number = tuple[Fraction, Fraction]
"""Real and imaginary part; of arrays, the two arrays."""


def multiply(a: tuple[Exact, Exact], b: tuple[Exact, Exact]) -> tuple[Exact, Exact]:
    """Return the product of two complex matrices."""
    return a[0] @ b[0] - a[1] @ b[1], a[0] @ b[1] + a[1] @ b[0]


def solve(M: tuple[Exact, Exact], right: tuple[Exact, Exact]) -> tuple[Exact, Exact]:
    """Return the solution of M X = right, complex matrices, by elimination with exchanges of rows."""
    both = np.block([[M[0], -M[1], right[0]], [M[1], M[0], right[1]]]) * Fraction(1)
    n = len(both)
    for k in range(n):
        pivot = next(i for i in range(k, n) if both[i, k] != 0)
        both[[k, pivot]] = both[[pivot, k]]
        both[k] /= both[k, k]
        for i in {*range(n)} - {k}:
            both[i] -= both[i, k] * both[k]
    return both[: n // 2, n:], both[n // 2 :, n:]


class Plant:
    """A generalised plant in fractions."""

    def __init__(self, plain: Plain) -> None:
        self.A, self.B1, self.B2, self.C1, self.C2, self.D11, self.D12, self.D21 = (
            to_fractions(plain[name]) for name in NAMES
        )
        self.free = np.array(plain["free"], dtype=bool)
        self.respond, self.characterise = cache(self._respond), cache(self._characterise)

    def gain(self, corner: tuple[Fraction, ...]) -> Exact:
        """Return the gain of values of the free entries."""
        K = np.full(self.free.shape, Fraction(0), dtype=object)
        K[self.free] = corner
        return K

    def _characterise(self, corner: tuple[Fraction, ...]) -> list[Fraction]:
        """Return the characteristic polynomial of the loop at a corner, s^0 first."""
        A, over = to_whole(self.A + self.B2 @ self.gain(corner) @ self.C2)
        coefficients, _ = expand((A, 0 * A))
        return [Fraction(c, over**k) for k, (c, _) in enumerate([(1, 0), *coefficients])][::-1]

    def sign(self, s: Fraction) -> int:
        """Return the sign of det(s I - A) at a real s."""
        value = sum(c * s**k for k, c in enumerate(self.characterise((Fraction(0),) * int(self.free.sum()))))
        return 1 if value > 0 else -1

    def _respond(self, s: Number | None) -> tuple[list[tuple[Exact, Exact]], int]:
        """Return P11, P12, P21, P22 at s as whole numbers over a common one; None is infinity."""
        B, C = np.hstack([self.B1, self.B2]), np.vstack([self.C1, self.C2])
        real, imaginary = np.block([[self.D11, self.D12], [self.D21, 0 * self.C2 @ self.B2]]), 0 * C @ B
        if s is not None:
            identity = np.eye(len(self.A), dtype=object)
            X = solve((s[0] * identity - self.A, s[1] * identity), (B, 0 * B))
            real, imaginary = real + C @ X[0], imaginary + C @ X[1]
        whole, below = to_whole(np.array([real, imaginary]))
        z, w = len(self.C1), self.B1.shape[1]
        rows, columns = (slice(z), slice(z, None)), (slice(w), slice(w, None))
        return [(whole[0][part], whole[1][part]) for part in itertools.product(rows, columns)], below


def to_whole(values: Exact) -> tuple[Exact, int]:
    """Return fractions as whole numbers over a common one."""
    over = math.lcm(*(value.denominator for value in values.ravel()))
    return np.vectorize(int, otypes=[object])(values * over), over


def expand(L: tuple[Exact, Exact]) -> tuple[list[tuple[int, ...]], tuple[Exact, Exact]]:
    """Return the coefficients of det(t I - L) from t^(n-1) on, and adj(L), by Faddeev's recursion in whole numbers."""
    identity = np.eye(len(L[0]), dtype=object)
    last = M = identity, 0 * identity
    found: list[tuple[int, ...]] = []
    for k in range(1, len(identity) + 1):
        last, product = M, multiply(L, M)
        found.append(tuple(-np.trace(part) // k for part in product))
        M = product[0] + found[-1][0] * identity, product[1] + found[-1][1] * identity
    sign = (-1) ** (len(identity) - 1)
    return found, (sign * last[0], sign * last[1])


def root_above(value: Fraction) -> Fraction:
    """Return a fraction not below the square root, close to it."""
    scale = 1 << max(0, 200 - (value.numerator.bit_length() - value.denominator.bit_length()) // 2)
    return Fraction(math.isqrt(value.numerator * scale * scale // value.denominator) + 1, scale)


def evaluate(
    plant: Plant, inequality: Plain, corners: list[tuple[Fraction, ...]], level: Fraction | None
) -> list[Fraction]:
    """Return numbers not above the function of an inequality at the corners; without a level none of a norm counts."""
    if "power" in inequality:
        return [-plant.characterise(corner)[inequality["power"]] for corner in corners]
    if level is None:
        raise SystemExit("that no gain is stable is concluded from a norm, for which the proof has no level")
    s = point(inequality["s"])
    (p, over_p), (q, over_q) = vector(inequality["p"]), vector(inequality["q"])
    squares = square(p) * square(q) / (over_p * over_q) ** 2
    # At a real s the characteristic polynomials of stable loops are positive, and so is d but for a sign.
    sign = 0 if s is not None and s[1] != 0 else 1 if s is None else plant.sign(s[0])
    (P11, P12, P21, P22), below = plant.respond(s)
    row, column = multiply(adjoint(p), P12), multiply(P21, q)
    direct = multiply(multiply(adjoint(p), P11), q)
    values = []
    for corner in corners:
        K, over_K = to_whole(plant.gain(corner))
        L = over_K * below * np.eye(len(K), dtype=object) - K @ P22[0], -(K @ P22[1])
        coefficients, adjugate = expand(L)
        d, over_d = [(-1) ** len(K) * part for part in coefficients[-1]], (over_K * below) ** len(K)
        added = multiply(multiply(row, adjugate), (K @ column[0], K @ column[1]))
        along = (d[0] * direct[0] - d[1] * direct[1] + added[0])[0, 0]
        if sign * d[0] < 0:
            bound = Fraction(sign * d[0], over_d) / root_above(1 / squares)
        else:
            bound = root_above(Fraction(d[0] ** 2 + d[1] ** 2, over_d**2) * squares)
        values.append(Fraction(along, over_d * below * over_p * over_q) - level * bound)
    return values


def shift_argument(polynomial: list[Fraction], shift: Fraction) -> list[Fraction]:
    """Return p(s + shift) by Horner's scheme, s^0 first."""
    found = polynomial.copy()
    for start in range(len(found) - 1):
        for k in range(len(found) - 2, start - 1, -1):
            found[k] += shift * found[k + 1]
    return found


def is_hurwitz(polynomial: list[Fraction]) -> bool:
    """Whether all roots of a monic polynomial lie left of the imaginary axis, by Routh's scheme."""
    rows = polynomial[::-1][::2], polynomial[::-1][1::2]
    while rows[1]:
        if rows[0][0] <= 0 or rows[1][0] <= 0:
            return False
        upper, lower = rows[0], [*rows[1], *[Fraction(0)] * (len(rows[0]) - len(rows[1]))]
        rows = rows[1], [upper[k] - upper[0] / lower[0] * lower[k] for k in range(1, len(upper))]
    return True


def is_positive(h: list[Fraction]) -> bool:
    """Whether a polynomial, x^0 first, is positive for all x >= 0, by Sturm's sequence."""
    if h[0] <= 0 or h[-1] <= 0:
        return False
    chain = [h, [k * c for k, c in enumerate(h)][1:]]
    while len(chain[-1]) > 1:
        rest = chain[-2].copy()
        while len(rest) >= len(chain[-1]):
            factor, offset = rest[-1] / chain[-1][-1], len(rest) - len(chain[-1])
            rest = [c - factor * chain[-1][k - offset] if k >= offset else c for k, c in enumerate(rest)][:-1]
        while rest and rest[-1] == 0:
            rest.pop()
        if not rest:
            break
        chain.append([-c for c in rest])
    signs = [[p[end] for p in chain if p and p[end] != 0] for end in (0, -1)]
    changes = [sum(a * b < 0 for a, b in itertools.pairwise(values)) for values in signs]
    return changes[0] == changes[1]


def excludes_zero(corners: list[list[Fraction]]) -> bool:
    """Whether Re(p_c conj(p_0)) > 0 on the imaginary axis for each p_c and their mean p_0."""
    mean = [sum(column, Fraction(0)) / len(corners) for column in zip(*corners, strict=True)]
    n = len(mean) - 1
    for corner in corners:
        real = [
            sum((-1) ** (k + j) * corner[j] * mean[2 * k - j] for j in range(max(0, 2 * k - n), min(n, 2 * k) + 1))
            for k in range(n + 1)
        ]
        if not is_positive(real):
            return False
    return True


def point(plain: list[float] | None) -> Number | None:
    """Return a point of the half-plane, None for infinity."""
    s = None if plain is None else (Fraction(plain[0]), Fraction(plain[1]))
    if s is not None and s[0] < 0:
        raise SystemExit("a point lies left of the imaginary axis")
    return s


def is_out_of_reach(plant: Plant, step: Plain, level: Fraction) -> bool:
    """Whether a direction that no control reaches, or no measurement sees, keeps a response of at least the level."""
    (P11, P12, P21, _), below = plant.respond(point(step["s"]))
    path, T = (P12, P11) if step["at_output"] else (adjoint(P21), adjoint(P11))
    v, _ = vector(step["vector"])
    reached = multiply(path, solve(multiply(adjoint(path), path), multiply(adjoint(path), v)))
    p = v[0] - reached[0], v[1] - reached[1]
    return square(multiply(adjoint(T), p)) >= (level * below) ** 2 * square(p) > 0


def vector(pairs: list[list[float]]) -> tuple[tuple[Exact, Exact], int]:
    """Return a complex column as whole numbers over a common one."""
    whole, over = to_whole(np.array([[[Fraction(x)] for x in part] for part in zip(*pairs, strict=True)]))
    return (whole[0], whole[1]), over


def adjoint(M: tuple[Exact, Exact]) -> tuple[Exact, Exact]:
    """Return the conjugate transpose of a complex matrix."""
    return M[0].T, -M[1].T


def square(v: tuple[Exact, Exact]) -> Fraction:
    """Return the squared length of a complex vector."""
    return sum((Fraction(x * x) for part in v for x in part.ravel()), Fraction(0))


def is_excluded(plants: list[Plant], step: Plain, corners: list[tuple[Fraction, ...]], level: Fraction | None) -> bool:
    """Whether a step excludes the box with these corners."""
    if "shift" in step:
        shift = Fraction(step["shift"])
        loops = [shift_argument(plants[step["plant"]].characterise(corner), shift) for corner in corners]
        return shift >= 0 and excludes_zero(loops) and not is_hurwitz(loops[0])
    if "vector" in step:
        return level is not None and is_out_of_reach(plants[step["plant"]], step, level)
    named = [(Fraction(one["weight"]), plants[one["plant"]], one) for one in step["inequalities"]]
    if min(weight for weight, *_ in named) <= 0:
        return False
    sums = sum(weight * np.array(evaluate(plant, one, corners, level), dtype=object) for weight, plant, one in named)
    return all(value >= 0 for value in sums)


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
