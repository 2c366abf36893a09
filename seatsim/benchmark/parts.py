"""The parts of the benchmark by name, and what each needs that a machine may not have."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from typing import NamedTuple

from seatsim.benchmark.dampers import measure_dampers
from seatsim.benchmark.measurement import Cost
from seatsim.benchmark.native import has_compiler
from seatsim.benchmark.peers import measure_c, measure_heyoka, measure_numbalsoda, measure_scipy
from seatsim.benchmark.scaling import measure_cores, measure_dask, measure_lengths


class Part(NamedTuple):
    """A part: what it measures, how, and a sentence that says what this machine lacks for it (empty: nothing)."""

    title: str
    measure: Callable[[], Iterator[Cost]]
    lacks: str = ""


def list_parts(dampers: Sequence[str]) -> dict[str, Part]:
    """Return the parts by name, in the order in which they are measured; `dampers` are those of the part `dampers`."""
    return {
        "dampers": Part("a step of the loop with each damper", lambda: measure_dampers(dampers)),
        "length": Part("a step of a whole run, by length", measure_lengths),
        "cores": Part("a run of a sweep, by runs at once", measure_cores),
        "dask": Part("a run of a sweep on an embedded cluster", measure_dask,
                     _need("distributed", 'pip install "seatsim[cluster]"')),
        "c": Part("a step in C, written by hand", measure_c, "" if has_compiler() else "this machine has no gcc"),
        "scipy": Part("a step of scipy.integrate.solve_ivp, as accurate", measure_scipy),
        "numbalsoda": Part("a step of numbalsoda, as accurate", measure_numbalsoda,
                           _need("numbalsoda", "pip install numbalsoda, which needs cmake and a Fortran compiler")),
        "heyoka": Part("a step of heyoka, as accurate", measure_heyoka, _need("heyoka", "pip install heyoka")),
    }  # fmt: skip


def _need(module: str, command: str) -> str:
    return "" if find_spec(module) else f"{module} is not installed: {command}"
