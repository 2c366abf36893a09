"""Lanes on a CUDA device: many runs side by side.

A lane is a thread that runs the time loop of `seatsim.kernel.loop` with its state in registers. Only this module
compiles for a device. With `NUMBA_ENABLE_CUDASIM=1` numba runs the same kernel in Python, which takes some milliseconds
for every step of a lane and needs no device.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import cuda, float64, int64, void
from numpy.typing import NDArray

from seatsim.compilation.jit import define, jit
from seatsim.compilation.messages import report
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_data import CHANNELS, LoopInputs, LoopSetup
from seatsim.rig.state import State
from seatsim.schema.arrays import Array

_Form = tuple[str, tuple[tuple[str, type], ...]]
"""Source that builds a record out of rows, and the classes that it names."""

_POINTS = CELLS + 1
"""Points of the grid of `seatsim.kernel.inverse.invert`, as a number that the compiler takes for a constant."""
_THREADS = 64
"""Threads of a block: a lane takes so many registers that larger blocks leave some of them unused."""
_ROWS, _PLANES = float64[:, ::1], float64[:, :, ::1]
SIGNATURE = void(_ROWS, _ROWS, _ROWS, int64[::1], _PLANES, _PLANES, int64[::1])
"""Types of the arguments of a kernel."""


def has_device() -> bool:
    """Return whether numba can use a CUDA device, or simulates one."""
    return bool(cuda.is_available())


def free_memory() -> float:
    """Return the bytes that are free on the device; infinity where it is simulated."""
    return float(cuda.current_context().get_memory_info()[0])


class LaneStart(NamedTuple):
    """What a lane begins with: its constant parts, states, temperature in degC, suspension in m and m/s.

    `rig`, `followed`, `law` and `sensed` are the states of the rig, of the inverse's damper, of the law and of its
    sensors.
    """

    setup: LoopSetup
    rig: State
    followed: State
    law: State
    sensed: State
    temperature: float
    displacement: float
    velocity: float


class KernelError(Exception):
    """Why models do not compile for the device."""


class DeviceInputs(NamedTuple):
    """What L lanes begin with and what drives them.

    starts: their numbers, shape (numbers, L). floors, speeds: accelerations [m/s^2] and velocities [m/s] of F floors,
    shape (N, F). floor_of: the floor of each lane, shape (L,). noise: that of their readings, shape (M, READINGS, L).
    """

    starts: Array
    floors: Array
    speeds: Array
    floor_of: NDArray[np.int64]
    noise: Array


def run_on_device(template: LaneStart, inputs: DeviceInputs) -> tuple[Array, list[int]]:
    """Simulate L lanes; return their rows, shape (N, len(CHANNELS), L), and the samples that each of them reached.

    `template` gives the form that the lanes have in common: the classes of all their records.

    Raises:
        KernelError: the models do not compile for the device.
    """
    lanes = len(inputs.floor_of)
    kernel = _compile_kernel(_form_of(template))
    if isinstance(kernel, str):
        raise KernelError(kernel)
    out = cuda.device_array((len(inputs.floors), len(CHANNELS), lanes), np.float64)
    reached = cuda.device_array(lanes, np.int64)
    kernel[(lanes + _THREADS - 1) // _THREADS, _THREADS](*map(cuda.to_device, inputs), out, reached)
    return out.copy_to_host(), reached.copy_to_host().tolist()


@cache
def _compile_kernel(form: _Form) -> Any:
    """Return the compiled kernel for lanes of a form, or why it does not compile."""
    report(1)
    try:
        return cuda.jit(SIGNATURE)(_define_kernel(form))
    except Exception as error:  # a model of the user's own may hold anything, and numba has many errors
        return f"{type(error).__name__}: {str(error).strip().partition(chr(10))[0]}"
    finally:
        report(0)


def make_kernel(template: LaneStart) -> Callable[..., None]:
    """Return the kernel in Python for lanes of the form of a template; its arguments have the types `SIGNATURE`."""
    return _define_kernel(_form_of(template))


def _define_kernel(form: _Form) -> Callable[..., None]:
    source, classes = form
    gather = jit(define(f"def gather(rows, lane):\n    return {source}\n", "gather", dict(classes)))
    simulate = jit(run_loop)

    def run(
        starts: Array,
        floors: Array,
        speeds: Array,
        floor_of: NDArray[np.int64],
        noise: Array,
        out: Array,
        reached: NDArray[np.int64],
    ) -> None:
        lane = cuda.grid(1)
        if lane < len(floor_of):
            grid = cuda.local.array(_POINTS, float64)
            own, start = floor_of[lane], gather(starts, lane)
            none = floors[:0, own]
            inputs = LoopInputs(
                floors[:, own], speeds[:, own], none, none, none, none, none, 0.0, start.displacement, start.velocity,
                start.sensed, noise[:, :, lane], start.temperature,
            )  # fmt: skip
            reached[lane] = simulate(start.setup, inputs, start.rig, start.followed, start.law, out[:, :, lane], grid)

    return run


def numbers(record: tuple[object, ...]) -> list[float]:
    """Return the numbers of a record, any nesting of tuples, from the first field to the last.

    Raises:
        TypeError: a field is neither a number nor a record.
    """
    found: list[float] = []
    for part in record:
        if isinstance(part, tuple):
            found += numbers(part)
        elif isinstance(part, bool | int | float):
            found.append(part)
        else:
            raise TypeError(f"{type(part).__name__} is no number")
    return found


def _form_of(record: tuple[object, ...]) -> _Form:
    places, classes = iter(range(10_000)), dict[type, str]()
    source = _expression(record, places, classes)
    return source, tuple((name, cls) for cls, name in classes.items())


def _expression(part: object, places: Iterator[int], classes: dict[type, str]) -> str:
    if isinstance(part, tuple):
        inner = "".join(f"{_expression(each, places, classes)}, " for each in part)
        if type(part) is tuple:
            return f"({inner})"
        name = classes.setdefault(type(part), f"{type(part).__name__}_{len(classes)}")
        return f"{name}({inner})"
    value = f"rows[{next(places)}, lane]"
    if isinstance(part, bool):
        return f"{value} != 0.0"
    return f"int({value})" if isinstance(part, int) else value
