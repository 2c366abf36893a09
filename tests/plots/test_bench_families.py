"""Which rows of a characterisation share a panel, and in which order."""

import math

import numpy as np

from seatsim.characterisation.rows import Row
from seatsim.plots.bench import loops as families
from seatsim.plots.bench.characterisation import (
    BY_CURRENT,
    BY_FREQUENCY,
    BY_TEMPERATURE,
    choose_abscissas,
    choose_looks,
)
from seatsim.simulation.damper_bench import SineTest

PHASE = np.linspace(0.0, 2.0 * np.pi, 101)


def row(current=0.0, temperature=math.nan, amplitude=0.01, frequency=1.0, record="bench, 0 A"):
    """Return a row with a loop of a viscous damper."""
    velocity = amplitude * 2.0 * np.pi * frequency * np.cos(PHASE)
    loop = SineTest(PHASE / (2.0 * np.pi * frequency), amplitude * np.sin(PHASE), velocity, 500.0 * velocity)
    return Row(record=record, file="", cycles=3, left_out=0, current=current, temperature=temperature,
               temperature_range=0.0, amplitude=amplitude, frequency=frequency, loop=loop)  # fmt: skip


def names_of(family):
    return [name for name, _ in family.loops]


def test_loops_are_ordered_by_current_when_coldest_and_by_temperature_at_the_largest_current():
    family = families.order_by_current([row(i, t) for i in (2.0, 0.0, 1.0) for t in (20.0, 60.0)])
    assert names_of(family) == ["0 A", "1 A", "2 A"] and family.legend == "current"
    assert family.title == "10 mm, 1 Hz, 20 °C"
    family = families.order_by_temperature([row(i, t) for i in (0.0, 1.0, 0.99) for t in (60.0, 20.0)])
    assert names_of(family) == ["20 °C", "20 °C", "60 °C", "60 °C"] and family.legend == "temperature"


def test_one_current_is_ordered_by_temperature_or_by_record():
    warm = families.order_by_current([row(1.0, t) for t in (60.0, 20.0)])
    assert warm.legend == "temperature" and names_of(warm) == ["20 °C", "60 °C"]
    same = families.order_by_current([row(1.0, record=f"run {k}, 1 A") for k in range(2)])
    assert same.legend == "record" and names_of(same) == ["run 0", "run 1"]


def test_settings_beyond_the_most_are_counted():
    rows = [row(i, frequency=f) for f in range(1, 9) for i in (0.0, 1.0)]
    found, left_out = families.find_families(rows)
    assert len(found) == families.MOST and left_out == 2
    assert found[0].title == "10 mm, 1 Hz" and found[-1].title == "10 mm, 8 Hz"


def test_figures_are_drawn_over_what_varies():
    by_both = choose_abscissas([row(i, t) for i in (0.0, 1.0) for t in (20.0, 60.0)])
    assert [across for across, _ in by_both] == [BY_CURRENT, BY_TEMPERATURE]
    assert choose_abscissas([row(1.0, frequency=f) for f in (1.0, 2.0)])[0][0] is BY_FREQUENCY
    looks, note = choose_looks(by_both)
    assert list(looks) == ["10 mm, 1 Hz"]
    assert note == "Over current at 20 °C; over temperature at 1 A."
