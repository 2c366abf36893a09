"""The tables of a bench day, as records: forces, gas and friction, hysteresis, energy, fade, responses, limits.

Limits that a damper has to keep are on figures of these tables.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple, get_args, get_type_hints

from seatsim.schema.content import Form
from seatsim.schema.fields import param, read_packaged
from seatsim.schema.validation import check_keys, mapping, read_number
from seatsim.schema.yaml_source import Source

_Current = Annotated[float, param("A", "current")]
_Warmth = Annotated[float, param("degC", "temperature of the damper")]
_Speed = Annotated[float, param("m/s", "peak speed")]
_Force = Annotated[float, param("N", "force")]
_Stiffness = Annotated[float, param("N/m", "stiffness")]
_Length = Annotated[float, param("m", "amplitude")]
_Frequency = Annotated[float, param("Hz", "frequency")]
_Energy = Annotated[float, param("J", "energy")]
_Damping = Annotated[float, param("N s/m", "equivalent damping")]
_PerKelvin = Annotated[float, param("1/K", "relative change")]
_Time = Annotated[float, param("s", "time")]


class PeakForce(NamedTuple):
    """Force at the peak speed in either direction, mean of the repeats, and the larger standard deviation of them."""

    current: _Current
    temperature: _Warmth
    speed: _Speed
    rebound: _Force
    compression: _Force
    repeats: int
    spread: _Force


class StepResponse(NamedTuple):
    """Times in s from the current's own 10 % (a command's step) on, of the force; overshoot over the change.

    start, t10, t63, t90: the force has covered 5, 10, 63.2 and 90 % of its change. settling: from then on it keeps
    within 5 % of its end. recovery: from first reaching 90 % until it no longer falls below; 0 where it does not.
    """

    before: Annotated[_Current, Form(key="from")]
    after: Annotated[_Current, Form(key="to")]
    speed: _Speed
    direction: str
    start: _Time
    t10: _Time
    t63: _Time
    t90: _Time
    settling: _Time
    recovery: _Time
    overshoot: float


class SlowForce(NamedTuple):
    """Mean of both directions at mid-stroke, and its slope over the middle 80 %, of the slowest test."""

    current: _Current
    temperature: _Warmth
    speed: _Speed
    force: _Force
    stiffness: _Stiffness


class Friction(NamedTuple):
    """Half the difference of both directions at mid-stroke of the slowest test."""

    current: _Current
    temperature: _Warmth
    speed: _Speed
    force: _Force


class Share(NamedTuple):
    """A ratio of forces at one speed in either direction, and of their difference, which has no gas force."""

    current: _Current
    temperature: _Warmth
    speed: _Speed
    rebound: float
    compression: float
    both: float


class Hysteresis(NamedTuple):
    """Difference in N of the two forces at which a cycle passes a speed of 0, and half of its peak speed."""

    current: _Current
    temperature: _Warmth
    speed: _Speed
    width: _Force
    width_at_half_speed: _Force


class CycleEnergy(NamedTuple):
    """Energy in J dissipated in a cycle, the viscous damping in N s/m that dissipates the same, and the asymmetry."""

    current: _Current
    temperature: _Warmth
    amplitude: _Length
    frequency: _Frequency
    speed: _Speed
    energy: _Energy
    damping: _Damping
    asymmetry: float


class Fade(NamedTuple):
    """Change of the force at the peak speed in 1/K, over that at the lowest temperature, between two temperatures.

    A row that names a record is of its cycles, others of several records.
    """

    current: _Current
    speed: _Speed
    coldest: _Warmth
    warmest: _Warmth
    per_kelvin: _PerKelvin
    record: str = ""


class LimitCheck(NamedTuple):
    """A figure against a limit: the worst value, and whether it passes."""

    name: str
    value: float
    limit: float
    bound: str
    passes: Annotated[bool, Form(key="pass")]

    def __str__(self) -> str:
        value = f"{self.value:.4g}" if math.isfinite(self.value) else "not determined"
        return f"{self.name}: {value}, {self.bound} {self.limit:g}: {'pass' if self.passes else 'FAIL'}"


class BenchSheet(NamedTuple):
    """The tables; SI units, degC, a force is positive in rebound.

    `beside` holds the peak forces of a model in the same tests.
    """

    peak_forces: list[PeakForce]
    response: list[StepResponse]
    gas_force: list[SlowForce]
    friction: list[Friction]
    dynamic_range: list[Share]
    linearity: list[Share]
    hysteresis: list[Hysteresis]
    energy: list[CycleEnergy]
    fade: list[Fade]
    limits: Sequence[LimitCheck] = ()
    beside: Sequence[PeakForce] = ()


def list_tables(sheet: BenchSheet) -> dict[str, tuple[type, Sequence[object]]]:
    """Return the class of the rows and the rows of each table, by its name."""
    hints = get_type_hints(BenchSheet, include_extras=True)
    return {name: (get_args(hints[name])[0], getattr(sheet, name)) for name in BenchSheet._fields}


_TIMES = ("start", "t10", "t63", "t90", "settling", "recovery", "overshoot")
_FIGURES = read_packaged(Path(__file__).with_name("limited_figures.yaml"), dict[str, tuple[str, str]])
"""Table and column of each figure that may have a limit, beside the times of responses."""


def check_limits(sheet: BenchSheet, file: Path) -> list[LimitCheck]:
    """Return each limit of a file, `limits: {t90_up: {max: 0.025}}`, with the worst value of its figure.

    A figure is one of `_FIGURES`, or one of the response times with `_up` or `_down`, for steps to a larger or to a
    smaller current. A figure that the tables do not hold fails.

    Raises:
        InputError: the file holds no limits, or one of them is on no such figure or no number.
    """
    source = Source(file)
    check_keys(source.data, ("limits",), source, ())
    figures, stated = _list_figures(sheet), mapping(source.data.get("limits"), source, ("limits",))
    check_keys(stated, figures, source, ("limits",))
    found = []
    for name, bounds in stated.items():
        keys = ("limits", name)
        limits = mapping(bounds, source, keys)
        check_keys(limits, ("min", "max"), source, keys)
        for bound, value in limits.items():
            limit = read_number(value, source, (*keys, bound))
            worst = (max if bound == "max" else min)(figures[name], default=math.nan)
            found.append(LimitCheck(name, worst, limit, bound, worst <= limit if bound == "max" else worst >= limit))
    return found


def _list_figures(sheet: BenchSheet) -> Mapping[str, list[float]]:
    """Return the values of every figure that may have a limit."""
    found = {name: _list_column(getattr(sheet, table), column) for name, (table, column) in _FIGURES.items()}
    for name in _TIMES:
        for way, sign in (("up", 1.0), ("down", -1.0)):
            rows = [each for each in sheet.response if sign * (each.after - each.before) > 0.0]
            found[f"{name}_{way}"] = _list_column(rows, name)
    return found


def _list_column(rows: Iterable[object], column: str) -> list[float]:
    """Return the values of a column that are known."""
    return [value for row in rows if math.isfinite(value := getattr(row, column))]
