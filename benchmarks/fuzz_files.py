"""Valid files for the readers: tables in several formats, a design, a diagnosis, a sealed set."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import cast

KEY = "c2VhdHNpbS1mdXp6LXJlYWRlcnMtMzItYnl0ZXMhISE="
"""A key for the sealed file."""


def make_formats(table: bytes) -> dict[str, bytes]:
    """Return the table in the formats whose libraries are there."""
    import io

    import pandas as pd
    import scipy.io

    frame = pd.read_csv(io.BytesIO(table)).head(200)
    files: dict[str, bytes] = {}
    for name, write in (("a.parquet", frame.to_parquet), ("a.feather", frame.to_feather)):
        packed = io.BytesIO()
        write(packed)
        files[name] = packed.getvalue()
    packed = io.BytesIO()
    scipy.io.savemat(cast("str", packed), {str(name): frame[name].to_numpy() for name in frame})
    files["a.mat"] = packed.getvalue()
    return files


def make_design() -> bytes:
    """Return a design of a plant of two states."""
    import numpy as np

    from controllers.synthesis import synthesise

    with tempfile.TemporaryDirectory() as place:
        two, one = np.eye(2), np.ones((1, 1))
        found = synthesise(
            np.array([[0.0, 1.0], [-4.0, -0.4]]), np.array([[0.0], [1.0]]), np.array([[0.0], [1.0]]), two, two,
            np.zeros((2, 1)), 0.1 * np.vstack([one, one]), np.zeros((2, 1)), time_budget=2.0,
        )  # fmt: skip
        found.save(Path(place) / "design.yaml")
        return (Path(place) / "design.yaml").read_bytes()


def make_diagnosis() -> bytes:
    """Return a `diagnosis.json`."""
    return (
        b'{"verdict": "known", "where": [{"block": "damper", "share": 0.9}], "causes": [{"effect": "damper.remanence",'
        b' "probability": 0.97, "shrink": 0.87, "parameters": {"width": {"value": 0.08, "std": 0.004, "unit": "A"}}}],'
        b' "selected": ["damper.remanence"], "indistinguishable": [], "experiment": null, "held_out": ["run-c"],'
        b' "gap": {"before": {"overall": 0.31, "channels": {"damper_force": 0.4}}, "shrink": 0.87,'
        b' "shrink_interval": [0.82, 0.9]}, "augmented": "augmented.yaml"}'
    )


def make_manifest() -> bytes:
    """Return the manifest of a command."""
    return (
        b'{"seed": 1, "versions": {"seatsim": "0.1.0"}, "platform": {"system": "Linux"}, "command": "comfort",'
        b' "arguments": ["--hours=6.0", "--", "rec"], "directory": "../..", "folder": "c", "own_code": [],'
        b' "inputs": [{"path": "../../rec/recording.yaml", "sha256": "00", "bytes": 4}],'
        b' "outputs": [{"path": "comfort.json", "sha256": "00", "bytes": 4}], "measured": {}}'
    )


def make_sealed() -> dict[str, bytes]:
    """Return a sealed file and the seal of its set."""
    from seatsim.blind.sealed import SEAL, Sealed, seal

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "set"
        folder.mkdir()
        seal(Path(place) / "sealed", folder, KEY, Sealed({}, {"case-0001": {"run.csv": b"a\n1\n"}}, {"seed": 1}))
        return {"sealed": (Path(place) / "sealed").read_bytes(), "folder-seal.txt": (folder / SEAL).read_bytes()}
