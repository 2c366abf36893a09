"""Certificates of saved designs in rational arithmetic: `python benchmarks/exact_certificates.py DESIGN.yaml ...`.

Shares no code with the synthesis. For every loop of a design it forms A, B, C, D of the closed loop, P = T'T and the
bounded-real matrix M from the file's doubles as fractions, and eliminates: P > 0 and M < 0 where no pivot has the wrong
sign. That proves, without rounding, that the loop is stable with H-infinity norm below the certificate's gamma.
"""

from __future__ import annotations

import argparse
import time
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML

NAMES = ("A", "B1", "B2", "C1", "C2", "D11", "D12", "D21")
Rows = list[list[float]]
Exact = NDArray[np.object_]
"""Array of fractions."""


Plain = dict[str, Any]
"""What a file states: of a loop its `plant`, matrices by name, and its `certificate`: `factor`, `gamma`, `delta`."""


def to_fractions(rows: Rows) -> Exact:
    """Return doubles as the fractions that they are."""
    return np.array([[Fraction(value) for value in row] for row in rows], dtype=object)


def is_positive_definite(M: Exact) -> bool:
    """Whether all pivots of the elimination of a symmetric matrix are positive."""
    M = M.copy()
    for k in range(len(M)):
        if not M[k, k] > 0:
            return False
        M[k + 1 :, k + 1 :] -= np.outer(M[k + 1 :, k], M[k, k + 1 :] / M[k, k])
    return True


def is_proven(gain: Rows, loop: Plain) -> bool:
    """Whether the certificate of a loop proves its gamma."""
    proof, K = loop["certificate"], to_fractions(gain)
    A, B1, B2, C1, C2, D11, D12, D21 = (to_fractions(loop["plant"][name]) for name in NAMES)
    A, B, C, D = A + B2 @ K @ C2, B1 + B2 @ K @ D21, C1 + D12 @ K @ C2, D11 + D12 @ K @ D21
    T, gamma = to_fractions(proof["factor"]), Fraction(proof["gamma"])
    P = T.T @ T
    w, z = gamma * np.eye(B.shape[1], dtype=int), gamma * np.eye(len(C), dtype=int)
    M = np.block([[-(A.T @ P + P @ A), -P @ B, -C.T], [-B.T @ P, w, -D.T], [-C, -D, z]])
    return is_positive_definite(P) and is_positive_definite(M)


def main() -> None:
    """Print a line for every loop of every design."""
    parser = argparse.ArgumentParser(description="check the certificates of designs in fractions")
    parser.add_argument("designs", nargs="+", metavar="DESIGN", help="a `design.yaml` of `seatsim synthesise`")
    for path in parser.parse_args().designs:
        design = YAML(typ="safe").load(Path(path))
        for i, loop in enumerate(design["loops"]):
            begin = time.process_time()
            verdict = check(design["gain"], loop)
            print(f"{path} loop {i}: {verdict} in {time.process_time() - begin:.1f} s", flush=True)


def check(gain: Rows, loop: Plain) -> str:
    """Return what a loop's certificate is worth, in words."""
    proof = loop["certificate"]
    if proof is None:
        return "no certificate"
    verdict = "proven" if is_proven(gain, loop) else "REFUTED"
    return f"{verdict} at {proof['gamma']:.9g} = gamma (1 + {proof['delta']:.0e})"


if __name__ == "__main__":
    main()
