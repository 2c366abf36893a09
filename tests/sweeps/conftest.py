"""A short sweep, and how it is written and carried out."""

import pytest
from ruamel.yaml import YAML

from seatsim.sweeps.engines import LocalEngine
from seatsim.sweeps.execute import execute, prepare

from ..conftest import SEAT

MASSES = {"plant.driver_mass": {"normal": [80, 12], "low": 50, "high": 120}}
FLOOR = '''
"""An excitation of a user."""
import os, signal, time
from multiprocessing import parent_process
from pathlib import Path
from typing import Annotated, NamedTuple

from seatsim.excitations.base import Floor, excitation
from seatsim.excitations.iso7096 import Iso7096
from seatsim.schema.fields import param

@excitation("{name}", source="a test")
class Own(NamedTuple):
    """Class EM5."""
    duration: Annotated[float, param("s", "length of the run", above=0, high=60)] = 0.5

    def floor(self, step: float, seed: int) -> Floor:
        """Return the motion of the floor."""
{first}
        return Iso7096(spectral_class="EM5", duration=self.duration).floor(step, seed)
'''


def floor_code(name, first):
    """Return the source of an excitation of class EM5 that does something else first."""
    return FLOOR.format(name=name, first=first)


@pytest.fixture
def write_sweep(tmp_path):
    """Return a function that writes a sweep file of a seat on a floor of half a second; keys replace its own."""

    def write(**stated):
        scenario = YAML(typ="safe").load(SEAT.replace("duration: 6.0", "duration: 0.5"))
        path = tmp_path / "sweep.yaml"
        content = {"scenario": scenario, "seed": 3, "design": "cross", "runs": 5, "vary": MASSES} | stated
        YAML().dump({key: value for key, value in content.items() if value is not None}, path)
        return path

    return write


@pytest.fixture
def carry_out(tmp_path):
    """Return a function that carries out a sweep file in this process alone, in a folder of `tmp_path`."""

    def carry(path, name="out", engine=LocalEngine(1), **options):  # noqa: B008  # a frozen value
        return execute(prepare(path), tmp_path / name, engine, **options)

    return carry


def bytes_of(folder):
    """Return the content of every part of a sweep, and of its manifest."""
    files = [*sorted(folder.glob("runs/part-*.parquet")), folder / "manifest.json"]
    # A manifest of a command names its own folder.
    own = f'"folder": "{folder.name}"'.encode()
    return {path.name: path.read_bytes().replace(own, b"") for path in files}
