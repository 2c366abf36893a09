"""The tests of a bench on a damper model: which model, at which settings, sines and steps of the command."""

import itertools
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from seatsim.characterisation.response import Response, StepEnsemble, estimate_response, find_crossing
from seatsim.characterisation.rows import WINDOW, Row, summarise_loops
from seatsim.characterisation.sheet import PeakForce
from seatsim.characterisation.summary import Characterisation
from seatsim.characterisation.tabulate import make_sheet
from seatsim.dampers.base import DAMPERS, Damper, DamperSpecification
from seatsim.rig.coil import Coil, relax
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.damper import read_damper
from seatsim.schema.errors import InputError
from seatsim.schema.registry import name_of
from seatsim.schema.validation import build, mapping
from seatsim.schema.yaml_source import Source
from seatsim.schema.yaml_text import KeyPath
from seatsim.simulation.damper_bench import SineTest, bench_force, sine_test


class DamperSpecimen(NamedTuple):
    """A damper model with its parameters, temperature factors and coil; `stated` where a file states them."""

    damper: Damper
    factors: TemperatureFactors
    coil: Coil
    stated: bool = True

    @property
    def name(self) -> str:
        """Name of the model."""
        return name_of("damper", type(self.damper))

    @property
    def specification(self) -> DamperSpecification:
        """What is stated of the model."""
        return DAMPERS.specification_of(type(self.damper))


def load_specimen(model: str | None, parameters: Path | None) -> DamperSpecimen:
    """Return a model with the values of its record, or with the `parameters` of a file.

    The file is a damper, `{model: NAME, parameters: {...}, temperature_factors: {...}}`, or has one under `damper`, as
    a scenario has, with its coil under `actuator`.

    Raises:
        InputError: there is no such model, the file is not as described, or it is of another model.
    """
    if parameters is None:
        cls = DAMPERS.find(model or "")
        specification = DAMPERS.specification_of(cls)
        return DamperSpecimen(cls(), specification.factors, Coil(max_current=specification.max_current), False)
    source = Source(Path(parameters))
    whole = "damper" in source.data
    keys: KeyPath = ("damper",) if whole else ()
    values = source.data["damper"] if whole else source.data
    choice = read_damper(values, source, keys)
    named = mapping(values, source, keys)["model"]
    if model not in (None, named):
        problem = f"is '{named}', not the '{model}' of --model; leave --model out"
        raise source.error((*keys, "model"), problem)
    coil = Coil(max_current=DAMPERS.specification_of(type(choice.record)).max_current)
    if whole and "actuator" in source.data:
        coil = build(Coil, source.data["actuator"], source, ("actuator",), ("rate", "max_current"))
    return DamperSpecimen(choice.record, choice.factors, coil)


_FASTEST = (2.0, 1.0, 0.5, 0.2, 0.1)
"""Hz; the first that keeps to the model's speeds is the highest frequency where none is stated."""
_LARGEST = 0.01
"""m; largest amplitude where none is stated."""
_SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Currents over the largest for which the model holds."""


class _SweepSettings(NamedTuple):
    """Currents [A], temperatures [degC], amplitudes [m] and frequencies [Hz] of the tests."""

    currents: Sequence[float]
    temperatures: Sequence[float]
    amplitudes: Sequence[float]
    frequencies: Sequence[float]


def choose_settings(
    tested: DamperSpecimen, currents: str = "", temperatures: str = "", amplitudes: str = "", frequencies: str = ""
) -> _SweepSettings:
    """Return the settings that are stated as numbers between commas, and for the others those for which a model holds.

    By default: five currents up to the largest; the least, mean and largest temperature where these matter, else the
    one at which the factors are 1; amplitudes up to 10 mm and frequencies up to 2 Hz, as far as the model's largest
    speed permits.

    Raises:
        InputError: a list is not of numbers, or one of them is out of bounds.
    """
    specification, factors = tested.specification, tested.factors
    largest = min(specification.max_current, tested.coil.max_current)
    low, high = specification.temperatures
    warm = [low, 0.5 * (low + high), high] if any(factors[:3]) and high > low else [factors.reference]
    far = _parse_numbers("--amplitudes", amplitudes, "m", "0.005,0.01", above=0.0)
    fast = _parse_numbers("--frequencies", frequencies, "Hz", "0.5,1,2", above=0.0)
    reach = specification.max_speed / (2.0 * math.pi)
    if not far:
        largest_far = _round_down(min(_LARGEST, reach / max(fast))) if fast else _LARGEST
        far = [0.5 * largest_far, largest_far]
    if not fast:
        top = next((f for f in _FASTEST if f * max(far) <= reach), _FASTEST[-1])
        fast = [0.25 * top, 0.5 * top, top]
    flowing = _parse_numbers("--currents", currents, "A", "0,0.5,1", low=0.0)
    warmth = _parse_numbers("--temperatures", temperatures, "degC", "20,50,80", low=-50.0, high=200.0)
    return _SweepSettings(flowing or [round(share * largest, 9) for share in _SHARES], warmth or warm, far, fast)


def _round_down(value: float) -> float:
    """Return a value rounded down to one digit."""
    digit = 10.0 ** math.floor(math.log10(value))
    return round(math.floor(value / digit + 1e-9) * digit, 12)


def _parse_numbers(
    option: str,
    text: str,
    unit: str,
    example: str,
    low: float = -math.inf,
    high: float = math.inf,
    above: float = -math.inf,
) -> list[float]:
    bounds = f" of at least {low:g}" if low > -math.inf else f" above {above:g}" if above > -math.inf else ""
    bounds += f" and at most {high:g}" if high < math.inf else ""
    values = []
    for part in text.split(",") if text.strip() else []:
        try:
            value = float(part)
        except ValueError:
            value = math.nan
        if not (low <= value <= high and value > above and math.isfinite(value)):
            raise InputError(
                f"{option} {text}: '{part.strip()}' is not permitted; write numbers{bounds} {unit} between commas,"
                f" such as {option} {example}"
            )
        values.append(value)
    return sorted(set(values))


_SETTLED = 3.0
"""Seconds a sine runs at least before its last cycle is taken: models forget their start in that time."""
_STEP = 1e-4
"""Seconds of a step of current between two values of the force."""
_BEFORE = 0.2
"""Seconds of constant speed before the step."""
_TIME_CONSTANTS = 12.0
"""Time constants of the coil after the step."""


def characterise_model(tested: DamperSpecimen, chosen: _SweepSettings, window: float = WINDOW) -> Characterisation:
    """Return what a bench would show of a model: sine tests at all settings, and steps of the command.

    Raises:
        RunError: the damper's state ran away in one of the tests.
    """
    rows = []
    for x, f, warm, i in itertools.product(chosen.amplitudes, chosen.frequencies, chosen.temperatures, chosen.currents):
        test = _test_sine(tested, x, f, i, warm)
        row = summarise_loops([test], f"{1e3 * x:g} mm, {f:g} Hz, {i:g} A, {warm:g} degC", "", i, warm)
        # One cycle is like the other.
        rows.append(row._replace(cycle_values=None))
    speed = 0.5 * min(max(row.peak_speed for row in rows), tested.specification.max_speed)
    answers = list(_responses(tested, chosen, speed))
    source, notes = f"{tested.name}: {tested.damper}", list(_notes(tested, chosen))
    return Characterisation(tested.name, source, False, rows, answers, notes, make_sheet(rows, answers, window))


def model_peaks(tested: DamperSpecimen, rows: Sequence[Row], window: float) -> list[PeakForce]:
    """Return the peak forces of a model in the tests of measured rows, each at the temperature that the row states.

    Raises:
        RunError: the damper's state ran away in one of the tests.
    """
    modelled = []
    for row in rows:
        if row.loop is not None:
            warm = row.temperature if math.isfinite(row.temperature) else tested.factors.reference
            modelled.append(row._replace(loop=_test_sine(tested, row.amplitude, row.frequency, row.current, warm)))
    return make_sheet(modelled, [], window).peak_forces


def _test_sine(tested: DamperSpecimen, x: float, f: float, current: float, warm: float) -> SineTest:
    """Return a cycle of a sine after which the model has forgotten its start."""
    cycles = max(3, math.ceil(_SETTLED * f) + 1)
    test = sine_test(tested.damper, x, f, current, warm, tested.factors, cycles)
    return test._replace(time=test.time - test.time[0])


def _responses(tested: DamperSpecimen, chosen: _SweepSettings, speed: float) -> Iterator[Response]:
    currents = [i for i in chosen.currents if i <= tested.coil.max_current] or [0.0]
    low = min(currents)
    for pair in itertools.chain(((low, i) for i in currents if i > low), ((i, low) for i in currents if i > low)):
        yield step_response(tested, *pair, speed, chosen.temperatures[0])


def step_response(tested: DamperSpecimen, before: float, after: float, speed: float, temperature: float) -> Response:
    """Return the response of a model to a step of the command in A at a constant speed in m/s, through its coil.

    The force is counted between those of the same motion at either current (`estimate_response`), so that a spring or a
    slow state leaves no trace.

    Raises:
        RunError: the damper's state ran away.
    """
    coil = tested.coil
    slowest = min(rate for rate in (coil.rate, coil.rate_fall) if rate > 0.0)
    lead, rows = round(_BEFORE / _STEP), round((coil.delay + _TIME_CONSTANTS / slowest) / _STEP)
    time = np.asarray(0.5 * _STEP * np.arange(-2 * lead, 2 * rows + 1), dtype=float)
    late = np.maximum(time - coil.delay, 0.0)
    current = np.array([relax(coil, before, after, t) for t in late])
    motion = speed * time, np.full(len(time), speed)
    step, off, on = (
        bench_force(tested.damper, *motion, i, temperature, _STEP, tested.factors) for i in (current, before, after)
    )
    share = (current[::2] - before) / (after - before)
    t10, t95 = (find_crossing(time[::2], share, level) for level in (0.1, 0.95))
    blank = Response(
        "", before, after, 1, "simulated", speed=speed, current_t10=t10, current_t95=t95,
        current_overshoot=max(float(np.max(share)) - 1.0, 0.0), direction="rebound" if speed > 0.0 else "compression",
    )  # fmt: skip
    # The first half of the lead only brings the damper's state to this speed.
    kept = slice(lead // 2, None)
    if float(np.max(np.abs(on - off)[kept])) <= 1e-9 * float(np.max(np.abs(on))):
        return blank._replace(method="", note="the force does not depend on the current")
    step, off, on = (force[None, kept] for force in (step, off, on))
    return estimate_response(StepEnsemble(step, off, on, np.zeros(1), lead - lead // 2, 1.0 / _STEP), blank)


def _notes(tested: DamperSpecimen, chosen: _SweepSettings) -> Iterator[str]:
    """Yield what the user has to know of the settings."""
    specification = tested.specification
    if specification.complete and not tested.stated:
        yield f"{tested.name} is a form without a parameter set of its own; shown are the values of its record"
    speed = 2.0 * math.pi * max(chosen.frequencies) * max(chosen.amplitudes)
    if speed > 1.01 * specification.max_speed:
        yield f"speeds reach {speed:.3g} m/s; the model holds up to {specification.max_speed:g} m/s"
    if max(chosen.currents) > specification.max_current:
        yield f"currents reach {max(chosen.currents):g} A; the model holds up to {specification.max_current:g} A"
    if max(chosen.currents) > tested.coil.max_current:
        yield f"the coil carries {tested.coil.max_current:g} A at most: no response to a larger current is stated"
    low, high = specification.temperatures
    if any(tested.factors[:3]) and not low <= min(chosen.temperatures) <= max(chosen.temperatures) <= high:
        yield f"the model's temperatures are {low:g} to {high:g} degC"
    if len(chosen.temperatures) > 1 and not any(tested.factors[:3]):
        yield "temperature plays no part: state temperature_factors in a file for --parameters"
