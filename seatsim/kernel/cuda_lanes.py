"""Lanes on a CUDA device: one lane a thread, with its state in registers.

Only this module compiles for a device. With `NUMBA_ENABLE_CUDASIM=1` numba runs the same kernel in Python, which takes
some milliseconds for every step of a lane and needs no device.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from itertools import islice
from typing import Any, NamedTuple, cast

import numpy as np
from numba import cuda, float64, int64, void
from numba.core import config
from numpy.typing import NDArray

from seatsim.compilation.jit import define, jit
from seatsim.compilation.watch import report
from seatsim.kernel.inverse import CELLS
from seatsim.kernel.loop import run_loop
from seatsim.kernel.loop_inputs import LoopInputs, LoopSetup
from seatsim.kernel.numbers import SHARED, numbers
from seatsim.kernel.sums import NO_SUMS, LaneLimits, Summed, Sums
from seatsim.rig.state import State
from seatsim.schema.arrays import Array

Form = tuple[str, tuple[tuple[str, type], ...]]
"""Source that builds a record out of rows, and the classes that it names."""

POINTS = CELLS + 1
"""Points of the grid of `seatsim.kernel.inverse.invert`, as a number that the compiler takes for a constant."""
THREADS = 64
"""Threads of a block: a lane takes so many registers that larger blocks leave some of them unused."""
ROWS = float64[:, ::1]
SIGNATURE = void(*(float64,) * 4, ROWS, ROWS, ROWS, int64[::1], float64[:, :, ::1], ROWS, ROWS, ROWS)
"""Types of the arguments of a kernel."""


def is_simulated() -> bool:
    """Return whether numba simulates the device."""
    return bool(config.ENABLE_CUDASIM)


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


class LaneEnd(NamedTuple):
    """A lane after its run: its sums, the temperature of its damper in degC, the number of samples that it reached."""

    sums: Sums
    temperature: float
    reached: float


END = LaneEnd(NO_SUMS, 0.0, 0.0)


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


def run_on_device(
    template: LaneStart, limits: LaneLimits, inputs: DeviceInputs, depth: int
) -> tuple[list[LaneEnd], Any]:
    """Simulate L lanes and return their ends, and their drivers' accelerations in m/s^2, shape (N, L), on the device.

    `template` gives the form of the lanes (see `numbers.template_of`); `depth` is above the greatest delay in
    steps by two.

    Raises:
        KernelError: the models do not compile for the device.
    """
    lanes = len(inputs.floor_of)
    kernel = _compile_kernel(_form_of(template))
    if isinstance(kernel, str):
        raise KernelError(kernel)
    driver, commands, ends = (
        cuda.device_array((rows, lanes), np.float64) for rows in (len(inputs.floors), depth, len(numbers(END)))
    )
    given = [cuda.to_device(each) for each in inputs]
    kernel[(lanes + THREADS - 1) // THREADS, THREADS](*limits, *given, commands, driver, ends)
    return [_end_of(row) for row in ends.copy_to_host().T.tolist()], driver


def _end_of(row: list[float]) -> LaneEnd:
    values = iter(row)
    return LaneEnd(Sums(*islice(values, len(NO_SUMS))), *values)


@cache
def _compile_kernel(form: Form) -> Any:
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


def _define_kernel(form: Form) -> Callable[..., None]:
    gather, scatter, simulate = jit(_define_gather(form)), jit(_define_scatter(END)), jit(run_loop)

    def run(
        most_speed: float,
        most_current: float,
        coldest: float,
        hottest: float,
        starts: Array,
        floors: Array,
        speeds: Array,
        floor_of: NDArray[np.int64],
        noise: Array,
        commands: Array,
        driver: Array,
        ends: Array,
    ) -> None:
        lane = cuda.grid(1)
        if lane < len(floor_of):
            room = cuda.local.array(POINTS, float64)
            own, start = floor_of[lane], gather(starts, lane)
            none = floors[:0, own]
            inputs = LoopInputs(
                floors[:, own], speeds[:, own], none, none, none, none, none, 0.0, start.displacement, start.velocity,
                start.sensed, noise[:, :, lane], start.temperature,
            )  # fmt: skip
            limits = LaneLimits(most_speed, most_current, coldest, hottest)
            recorder: Any = Summed(driver[:, lane], commands[:, lane], room, limits)
            reached, sums, temperature = simulate(start.setup, inputs, start.rig, start.followed, start.law, recorder)
            scatter((sums, temperature, float(reached)), ends, lane)

    return run


def _form_of(record: tuple[object, ...]) -> Form:
    places, classes = iter(range(10_000)), dict[type, str]()
    source = _expression(record, places, classes)
    return source, tuple((name, cls) for cls, name in classes.items())


def _expression(part: object, places: Iterator[int], classes: dict[type, str]) -> str:
    if type(part) in SHARED:
        next(places)
        return repr(SHARED[type(part)])
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


def _define_gather(form: Form) -> Callable[..., Any]:
    """Return the function that builds the record of a lane out of its rows."""
    source, classes = form
    return define(f"def gather(rows, lane):\n    return {source}\n", "gather", dict(classes))


def _define_scatter(record: tuple[object, ...]) -> Callable[..., Any]:
    """Return the function that writes a record of this form into its rows."""
    lines = [f"    rows[{row}, lane] = {leaf}" for row, leaf in enumerate(_leaves(record, "record"))]
    return define("\n".join(["def scatter(record, rows, lane):", *lines, ""]), "scatter", {})


def _leaves(part: object, path: str) -> Iterator[str]:
    if isinstance(part, tuple):
        for index, each in enumerate(cast("tuple[object, ...]", part)):
            yield from _leaves(each, f"{path}[{index}]")
    else:
        yield path
