"""Properties of every effect, law and excitation at random parameters, within the bounds and about usual values.

An effect is put on a seat, which is shaken; a law is asked at random measurements, one after the other, on a random
seat; an excitation makes its floor. Counted are:

    raised      errors that are none of seatsim's
    finite      answers that are not finite
    split       runs whose first half is not, to the last bit, what a run of half the length gives; laws that go on from
                their state otherwise than in one go; floors that a second call or twice the step moves otherwise
    open        runs that do not account for 0.1 % of their energy: such a run is marked as unverified, no failure
    refused     sets that are refused by one sentence, as too stiff or contradictory: no failure
"""

from __future__ import annotations

import math
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError

from seatsim.effects.base import EFFECTS, Form, acts_on, off
from seatsim.excitations.base import Floor
from seatsim.kernel.generic import evaluate_law, update
from seatsim.metrics.motion import energy_residual
from seatsim.rig.coil import Coil
from seatsim.rig.control import Measurement, prepare_law
from seatsim.rig.plant import Plant
from seatsim.scenario.scenario import Scenario
from seatsim.schema.errors import SeatsimError
from seatsim.schema.fields import bounds, choices, describe, validated
from seatsim.schema.registry import find, initial_state
from seatsim.simulation.augment import read_sensors
from seatsim.simulation.simulate import simulate
from seatsim.simulation.validity import LARGEST_RESIDUAL

from .effects import rigs
from .laws.records import REQUIRED
from .robustness.test_damper_space import draw_value

STEP, SAMPLES = 1e-3, 600
INSTANTS = 20
OF_WHOLE_RUN = ("frame_force", "truth")
"""Hooks that are given a whole run, by whose length their answer may change."""
SEAT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
DRAWN = SEAT._fields[:6]
SIZES = Measurement(1.0, 0.02, 0.2, 0.2, 0.2, 1.0, 2.0, 2.0, 300.0, 0.5, 20.0, 1.0)
"""Usual size of each measurement, in its unit."""
USUAL: Mapping[str, Mapping[str, object]] = {
    **REQUIRED,
    "floor.unmeasured_input": {"rms": 10.0},
    "bumps": {"shape": "half_sine", "height": 0.05, "length": 1.0, "speed": 8.0, "duration": 2.0},
    "chirp": {"start_frequency": 0.5, "stop_frequency": 20.0, "amplitude": 0.01, "duration": 2.0},
    "iso7096": {"spectral_class": "EM3", "duration": 2.0},
    "rest": {"duration": 2.0},
    "road": {"road_class": "C", "speed": 12.0, "duration": 2.0},
    "sine": {"amplitude": 0.02, "frequency": 2.0, "duration": 2.0},
    "stepped_sine": {"frequencies": (1.0, 2.5, 4.0), "cycles": 2, "amplitude": 0.01},
}
"""Usual values of fields that have no default."""
DURATIONS = (0.1, 20.0)
"""Seconds of the floors that are drawn."""


def draw(rng: np.random.Generator, usual, cls: type, name: str, anywhere: bool):
    """Return a random value of a field of a class with a `usual` value, of the same kind; lists of words stay."""
    if name == "duration":
        return round(float(rng.uniform(*DURATIONS)), 2)
    if isinstance(usual, tuple) and usual and all(isinstance(each, str) for each in usual):
        return usual
    if isinstance(usual, bool | str):
        return rng.choice(choices(cls, name) or (False, True)).item()
    if isinstance(usual, int | float):
        low, high = bounds(cls, name)
        near = float(np.clip((usual or 0.01 * rng.normal()) * math.exp(0.5 * rng.normal()), low, high))
        value = draw_value(rng, usual, low, high) if anywhere else near
        return round(value) if isinstance(usual, int) else value
    if hasattr(usual, "_asdict"):
        return draw_record(rng, type(usual), usual._asdict(), anywhere)
    return tuple(draw(rng, each, cls, name, anywhere=False) for each in usual)


def draw_record(rng: np.random.Generator, cls: type, usual: Mapping[str, object], anywhere: bool):
    """Return a random record of a class, which its fields permit; what has no usual value keeps its default.

    Raises:
        ValidationError: the values contradict each other.
    """
    stated = {name: value for name, value in usual.items() if value is not None}
    return validated(cls, {name: draw(rng, value, cls, name, anywhere) for name, value in stated.items()})


def usual_values(rng: np.random.Generator, kind: str, name: str, cls: type) -> dict[str, object]:
    """Return usual values of a part: those of one of an effect's forms, or its defaults."""
    stated: dict[str, object] = {field.name: field.default for field in describe(cls)} | dict(USUAL.get(name, {}))
    if kind != "effect":
        return stated
    forms = EFFECTS.specification_of(cls).forms or (Form(USUAL[name]),)
    form = forms[rng.integers(len(forms))]
    words = {field: choices(cls, field)[0] for field in stated if choices(cls, field)}
    return dict(off(cls)._asdict()) | dict(form.fixed) | dict(form.free) | words


@cache
def seat() -> Scenario:
    """Return the seat that effects are put on: that of their tests."""
    with tempfile.TemporaryDirectory() as place:
        scenario: Scenario = rigs.seat(Path(place))
    return scenario


@cache
def shaking() -> Floor:
    """Return the floor of that seat."""
    scenario = seat()
    assert scenario.excitation is not None
    return first_samples(scenario.excitation.floor(STEP, scenario.seed), SAMPLES + 1)


def first_samples(floor: Floor, count: int) -> Floor:
    """Return the beginning of a floor."""
    return Floor(STEP, *(part[:count] for part in floor[1:4]))


def check_effect(rng: np.random.Generator, effect) -> Iterator[str]:
    """Yield what is wrong with a seat that has an effect."""
    scenario = replace(seat(), effects=(effect,))
    whole = simulate(scenario, shaking(), carry_all_effects=True).channels
    known = {name: values for name, values in whole.items() if not np.all(np.isnan(values))}
    read = read_sensors(scenario.effects, STEP, known)
    expected_nan = ("wanted_force", "force_served")
    if not all(np.all(np.isfinite(values)) for name, values in read.items() if name not in expected_nan):
        yield "finite"
    count = SAMPLES // 2 + 1
    half = simulate(scenario, first_samples(shaking(), count), carry_all_effects=True).channels
    is_same = all(np.array_equal(values, whole[name][:count], equal_nan=True) for name, values in half.items())
    if not is_same and not acts_on(type(effect), OF_WHOLE_RUN):
        yield "split"
    if "energy_floor" in known:
        parts = [known[f"energy_{part}"] for part in ("damper", "suspension", "cushion", "stored")]
        if energy_residual(known["energy_floor"], parts) > LARGEST_RESIDUAL:
            yield "open"


def check_law(rng: np.random.Generator, law) -> Iterator[str]:
    """Yield what is wrong with the answers of a law to random measurements."""
    factors = np.exp(0.3 * rng.normal(size=len(DRAWN)))
    plant = SEAT._replace(**{name: getattr(SEAT, name) * factor for name, factor in zip(DRAWN, factors, strict=True)})
    sample_time = float(rng.choice([0.001, 0.005, 0.02]))
    rest, coil = initial_state(type(law)), Coil(130.0, 1.0)
    tails = rng.standard_t(2.0, (INSTANTS, len(SIZES))) * np.array(SIZES)
    asked = [Measurement(*map(float, values)) for values in tails]
    answers, states = ask(prepare_law(law, plant, coil, sample_time), asked, rest)
    if not np.all(np.isfinite(answers)) or not all(map(math.isfinite, states[-1])):
        yield "finite"
    middle = INSTANTS // 2
    again, _ = ask(prepare_law(law, plant, coil, sample_time), asked[middle:], states[middle])
    if not np.array_equal(again, answers[middle:], equal_nan=True):
        yield "split"


def ask(law, asked: list[Measurement], state) -> tuple[list[float], list[object]]:
    """Return a law's answers, one after the other, and its states before each and after the last."""
    answers, states = [], [state]
    for y in asked:
        answers.append(evaluate_law(law, y, states[-1]))
        states.append(update(law, y, states[-1]))
    return answers, states


def check_excitation(rng: np.random.Generator, excitation) -> Iterator[str]:
    """Yield what is wrong with the floor of an excitation."""
    seed = int(rng.integers(1000))
    floor = excitation.floor(STEP, seed)
    if not all(np.all(np.isfinite(part)) for part in floor[1:4]):
        yield "finite"
    again, coarse = excitation.floor(STEP, seed), excitation.floor(2 * STEP, seed)
    is_same = all(np.array_equal(a, b) for a, b in zip(floor[1:4], again[1:4], strict=True))
    fine = floor.displacement[::2][: len(coarse.displacement)]
    apart = np.max(np.abs(coarse.displacement[: len(fine)] - fine))
    if not is_same or apart > 1e-3 * np.max(np.abs(floor.displacement)):
        yield "split"


CHECKS: Mapping[str, Callable[[np.random.Generator, object], Iterator[str]]] = {
    "effect": check_effect,
    "law": check_law,
    "excitation": check_excitation,
}


class Found(NamedTuple):
    """How often each finding occurred for a part, and a case of each with what was said."""

    counts: Counter[str]
    cases: dict[str, str]


def check(kind: str, name: str, sets: int, seed: int = 0) -> Found:
    """Return the findings about so many random sets of a part."""
    rng = np.random.default_rng([seed, *name.encode()])
    cls, found = find(kind, name), Found(Counter(), {})
    for _ in range(sets):
        part, said = None, ""
        try:
            part = draw_record(rng, cls, usual_values(rng, kind, name, cls), anywhere=bool(rng.integers(2)))
            with np.errstate(all="ignore"):
                findings = list(CHECKS[kind](rng, part))
        except (SeatsimError, ValidationError) as error:
            findings, said = ["refused"], str(error)
        except Exception as error:
            findings, said = ["raised"], f"{type(error).__name__}: {error}"
        found.counts.update(findings)
        for finding in findings:
            found.cases.setdefault(finding, f"{part} {said}")
    return found
