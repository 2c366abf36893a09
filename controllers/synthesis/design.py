"""A finished design, and the YAML file it is kept in. Reading one needs neither solver nor plant."""

from __future__ import annotations

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
from seatsim.files import write_whole


@dataclass(frozen=True, eq=False)
class Design:
    """A static output feedback `u = gain @ y` and what is known of its loop.

    `gain` (nu, ny) is in the user's units, every entry at most `max_gain` in magnitude. `gamma` is the H-infinity norm
    of the closed loop from w to z, on which two independent computations agree, attained at `peak_frequency` in rad/s
    (0 to infinity). `lower_bound` is what no linear controller of any order can go below. `certificate` proves gamma
    by the bounded-real lemma; None where double precision cannot (gains near infinity). `poles` are in rad/s.
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
        write_whole(Path(path), lambda part: _yaml().dump(_to_plain(self), part))

    @classmethod
    def load(cls, path: str | Path) -> Design:
        """Read a design that `save` wrote.

        Raises:
            InputError: the file is missing, is not YAML, or lacks a key; file and key are named.
        """
        try:
            plain = _yaml().load(Path(path))
        except (OSError, YAMLError) as error:
            raise InputError(f"{path}: cannot read the design: {error}") from error
        try:
            return _from_plain(plain)
        except KeyError as error:
            raise InputError(f"{path}: the design lacks the key {error}") from error
        except (TypeError, ValueError) as error:
            raise InputError(f"{path}: not a design: {error}") from error


def _yaml() -> YAML:
    yaml = YAML(typ="safe")
    yaml.default_flow_style, yaml.width = None, 1000
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    return yaml


def _to_plain(design: Design) -> dict[str, Any]:
    proof = design.certificate
    return {
        "gain": design.gain.tolist(),
        "gamma": design.gamma,
        "max_gain": design.max_gain,
        "lower_bound": design.lower_bound,
        "certificate": proof and {**vars(proof), "matrix": proof.matrix.tolist()},
        "peak_frequency": design.peak_frequency,
        "poles": [[float(pole.real), float(pole.imag)] for pole in design.poles],
    }


def _from_plain(plain: Any) -> Design:
    poles = np.array(plain["poles"], dtype=float)
    return Design(
        gain=np.array(plain["gain"], dtype=float),
        gamma=float(plain["gamma"]),
        max_gain=float(plain["max_gain"]),
        lower_bound=float(plain["lower_bound"]),
        certificate=plain["certificate"] and _proof(plain["certificate"]),
        peak_frequency=float(plain["peak_frequency"]),
        poles=poles[:, 0] + 1j * poles[:, 1],
    )


def _proof(plain: Any) -> Certificate:
    return Certificate(
        matrix=np.array(plain["matrix"], dtype=float),
        gamma=float(plain["gamma"]),
        delta=float(plain["delta"]),
        largest_eigenvalue=float(plain["largest_eigenvalue"]),
    )
