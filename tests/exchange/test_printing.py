"""Functions printed as C give what Python gives, bit by bit; what has no counterpart is refused by name."""

import ctypes
import math
import subprocess
from typing import NamedTuple

import numba
import numpy as np
import pytest

from seatsim.compilation.jit import jit
from seatsim.exchange.c_source import fill
from seatsim.exchange.export import find_compiler
from seatsim.exchange.printing.functions import print_function
from seatsim.exchange.printing.program import NotPrintableError, Program, Signature

TABLE = np.array([[1.0, 2.5], [0.1, 1e-9]])


class Inner(NamedTuple):
    gain: float
    law: tuple[float, float, float]


class Outer(NamedTuple):
    inner: Inner
    nothing: tuple[()]
    count: int

    def scaled(self, x):
        return self.inner.gain * x


@jit
def split(x):
    if x < 0.0:
        return -x, -1.0
    return x, 1.0


def powers(a, b):
    return a**2 + a**3 - (abs(a) + 0.1) ** b


def order_of_operations(a, b):
    return a - (b - 2.0) - -a / (b * 3.0 + 0.01) / 7.0 + (a + b) * (a - b)


def chained(a, b):
    return 1.0 if 0.0 < a <= b < 10.0 and not a > 9.0 else (0.5 if a > b or b != b else -1.0)


def looped(a, b):
    total, side = 0.0, 0
    for k in range(1, 6):
        if k == 3:
            continue
        total += a / k
        side = -1 if total > b else 1
        if total > 100.0:
            break
    n = 0
    while n < 4 and total < b:
        total = total * 2.0 + 1.0
        n += 1
    return total * side + n


def tuples(a, b):
    x = (a, b, a * b)
    y = (*x, 3.0)
    size, sign = split(b)
    a, b = b, a
    rest = x[1:] + (y[-1],)  # noqa: RUF005
    return rest[0] * sign + rest[2] + size + a - 2.0 * b + len(rest)


def records(a, b):
    r = Outer(Inner(a, (1.0, 2.0, b)), (), 3)
    r = r._replace(inner=r.inner._replace(gain=b))
    k = r.count // 2 + r.count % 2
    return r.scaled(a) + r.inner.law[0] + r.inner.law[2] * k + 1 / r.count


def arrays(a, b):
    scratch = np.empty(4)
    for k in range(4):
        scratch[k] = a * k
    row = TABLE[1 if b > 0.0 else 0]
    return scratch[3] - scratch[1] + row[0] + TABLE[0, 1]


def maths(a, b):
    u = max(abs(a), 0.1, b)
    return math.exp(-u) + math.log(u) + math.tanh(a) * math.atan(b) + math.copysign(math.sqrt(u), a) + min(a, b)


@jit
def shifted(a, b):
    a = a + b
    return a


def changing(a, b):
    n, total = 3, shifted(a, b)
    for k in range(n):
        n += 1
        total += k * shifted(b, 1.0)
    return total + n


FUNCTIONS = (changing, powers, order_of_operations, chained, looped, tuples, records, arrays, maths)
NUMBERS = (-3.7, -1.0, -0.0, 0.3, 1.0, 2.0, 17.25)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    program = Program(print_function)
    number = Signature(numba.float64)
    names = [program.function(function, (number, number)).name for function in FUNCTIONS]
    wrappers = [f"double c_{n}(double a, double b) {{ return {n}(a, b); }}" for n in names]
    folder = tmp_path_factory.mktemp("printed")
    source = "\n".join([fill("c/prelude.h"), program.source(), *wrappers])
    (folder / "all.c").write_text(source)
    flags = ["-std=c99", "-Wall", "-Werror", "-O2", "-ffp-contract=off", "-shared", "-fPIC"]
    command = [find_compiler(), *flags, "-o", str(folder / "all.so"), str(folder / "all.c"), "-lm"]
    subprocess.run(command, check=True)
    library = ctypes.CDLL(str(folder / "all.so"))
    found = {}
    for function, name in zip(FUNCTIONS, names, strict=True):
        entry = getattr(library, f"c_{name}")
        entry.restype, entry.argtypes = ctypes.c_double, [ctypes.c_double, ctypes.c_double]
        found[function] = entry
    return found


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.__name__)
def test_printed_functions_equal_python(compiled, function):
    for a in NUMBERS:
        for b in NUMBERS:
            expected = function(a, b)
            got = compiled[function](a, b)
            if function is powers:
                # A square is a product in compiled code, and a call of `pow` in Python.
                assert got == pytest.approx(expected, rel=1e-15, abs=1e-300)
            else:
                assert got == expected


def objects(a, b):
    return {"a": a}["a"] + b


def raising(a, b):
    if a > b:
        raise ValueError("too large")
    return a


def without_end(a, b):
    if a > b:
        return a


def growing(a, b):
    z = (a,)
    for _k in range(3):
        z = (*z, b)
    return z[0]


def printing(a, b):
    print(a)
    return b


@pytest.mark.parametrize("function", [objects, raising, without_end, growing, printing], ids=lambda f: f.__name__)
def test_what_has_no_counterpart_is_refused_by_name(function):
    number = Signature(numba.float64)
    with pytest.raises(NotPrintableError, match=f"test_printing.{function.__name__}"):
        Program(print_function).function(function, (number, number))
