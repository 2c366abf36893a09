"""A finished design, and the YAML file it is kept in. Reading one needs neither solver nor plant."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from controllers.synthesis.certify import Certificate
from controllers.synthesis.plant import Array
from seatsim.errors import InputError


@dataclass(frozen=True, eq=False)
class Design:
    """A static output feedback `u = gain @ y` and what is known of its loop.

    gain (nu, ny) in the user's units, every entry at most `max_gain` in magnitude; `gamma` the H-infinity norm of the
    closed loop from w to z, confirmed by two independent computations; `lower_bound` what no linear controller of any order
    can go below; `certificate` the proof by the bounded-real lemma, None where double precision cannot give one (gains near
    infinity); `peak_frequency` in rad/s where gamma is attained (may be infinity); `poles` of the closed loop in rad/s.
    """

    gain: Array
    gamma: float
    max_gain: float
    lower_bound: float
    certificate: Certificate | None
    peak_frequency: float
    poles: NDArray[np.complex128]

    def save(self, path: str | Path) -> None:
        """Write the design as YAML; the file appears whole or not at all."""
        _write_whole(Path(path), _to_plain(self))

    @classmethod
    def load(cls, path: str | Path) -> Design:
        """Read a design that `save` wrote.

        Raises:
            InputError: the file is missing, is not YAML, or lacks a key; the message names the file and the key.
        """
        try:
            with open(path, encoding="utf-8") as stream:
                plain = YAML(typ="safe").load(stream)
        except (OSError, YAMLError) as error:
            raise InputError(f"{path}: cannot read the design: {error}") from error
        try:
            return _from_plain(plain)
        except KeyError as error:
            raise InputError(f"{path}: the design lacks the key {error}") from error
        except (TypeError, ValueError) as error:
            raise InputError(f"{path}: not a design: {error}") from error


def _to_plain(design: Design) -> dict[str, Any]:
    proof = design.certificate
    return {
        "gain": design.gain.tolist(),
        "gamma": design.gamma,
        "max_gain": design.max_gain,
        "lower_bound": design.lower_bound,
        "certificate": None
        if proof is None
        else {
            "gamma": proof.gamma,
            "delta": proof.delta,
            "largest_eigenvalue": proof.largest_eigenvalue,
            "matrix": proof.matrix.tolist(),
        },
        "peak_frequency": design.peak_frequency,
        "poles": [[float(pole.real), float(pole.imag)] for pole in design.poles],
    }


def _from_plain(plain: Any) -> Design:
    proof = plain["certificate"]
    poles = np.array(plain["poles"], dtype=float)
    return Design(
        gain=np.array(plain["gain"], dtype=float),
        gamma=float(plain["gamma"]),
        max_gain=float(plain["max_gain"]),
        lower_bound=float(plain["lower_bound"]),
        certificate=None
        if proof is None
        else Certificate(
            np.array(proof["matrix"], dtype=float),
            float(proof["gamma"]),
            float(proof["delta"]),
            float(proof["largest_eigenvalue"]),
        ),
        peak_frequency=float(plain["peak_frequency"]),
        poles=poles[:, 0] + 1j * poles[:, 1],
    )


def _write_whole(path: Path, plain: dict[str, Any]) -> None:
    """Write beside the target, then rename: a reader never sees half a file."""
    yaml = YAML(typ="safe")
    yaml.default_flow_style = None
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            yaml.dump(plain, stream)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
