"""The same run in C, compiled with gcc and called through ctypes."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
from seat_run import DAMPER, GAIN, PLANT

from seatsim.kernel.loop_data import CHANNELS, LoopSetup

FLAGS = ("-O3", "-march=native", "-std=c11", "-Wall", "-Wextra", "-shared", "-fPIC")
LEAN_CHANNELS = (
    "floor_acceleration", "frame_acceleration", "driver_acceleration", "suspension_displacement",
    "suspension_velocity", "damper_force", "wanted_force", "coil_current", "current_command",
)  # fmt: skip
RECORDED = {"loop.c": CHANNELS, "lean.c": LEAN_CHANNELS}
Pointer = ctypes.POINTER(ctypes.c_double)


class _Setup(ctypes.Structure):
    """`LoopSetup` of the C files: 34 doubles in their order, then the steps per sample of the law."""

    _fields_ = (("values", ctypes.c_double * 34), ("sample_every", ctypes.c_long))


def native_run(
    source: str, folder: Path, acceleration: np.ndarray, parts: LoopSetup
) -> tuple[Callable[[], None], dict[str, np.ndarray]]:
    """Compile a C file into `folder`; return a function that runs it, and the channels that it fills."""
    library = folder / f"{source}.so"
    file = Path(__file__).parent / source
    subprocess.run(["gcc", *FLAGS, "-o", str(library), str(file), "-lm"], check=True)
    loop = ctypes.CDLL(str(library)).run_loop
    loop.restype = ctypes.c_long
    loop.argtypes = (ctypes.POINTER(_Setup), ctypes.c_long, Pointer, Pointer)
    given, samples = _values(parts), len(acceleration)
    history = np.empty((samples, len(RECORDED[source])))
    floor, out = (array.ctypes.data_as(Pointer) for array in (acceleration, history))

    def run() -> None:
        if loop(ctypes.byref(given), samples, floor, out) != samples:
            raise RuntimeError("the solution left all bounds")

    return run, dict(zip(RECORDED[source], history.T, strict=True))


def _values(parts: LoopSetup) -> _Setup:
    d, coil, timing = DAMPER, parts.coil, parts.timing
    values = (
        *PLANT[:6], *d.c0, *d.c1, *d.alpha, d.k0, d.k1, d.x0, d.f0, d.A, d.beta, d.gamma, d.n, d.law_end,
        coil.rate, coil.max_current, *GAIN, timing.step, timing.tolerance, 20.0,
    )  # fmt: skip
    return _Setup((ctypes.c_double * 34)(*values), timing.sample_every)
