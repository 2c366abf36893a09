"""Effects are put where they act, in order, and leave everything else as it was."""

from typing import NamedTuple

import numpy as np
import pytest

from seatsim.dampers.bingham import Bingham
from seatsim.effects.base import ON_DAMPER, ON_SEAT, acts_on, off
from seatsim.kernel.augmented import AugmentedDamper
from seatsim.rig.coil import Coil
from seatsim.rig.plant import Plant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.schema.registry import find, names, specification_of
from seatsim.simulation.augment import (
    augment_coil,
    augment_damper,
    augment_factors,
    augment_plant,
    augment_temperature,
    read_sensors,
    select_in_loop,
    undo_reading,
)

PLANT_80 = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
COIL = Coil(rate=130.0, max_current=1.0)


def effect(name, **values):
    return off(find("effect", name))._replace(**values)


class Doubled(NamedTuple):
    """An effect that doubles whatever it may change."""

    def plant(self, plant):
        return plant._replace(driver_mass=2.0 * plant.driver_mass)

    def coil(self, coil):
        return coil._replace(rate=2.0 * coil.rate)

    def factors(self, factors):
        return factors._replace(viscous=2.0 * factors.viscous)

    def temperature(self, step, values):
        return 2.0 * values + step

    def frame_force(self, time, seed):
        return time + seed

    def reading(self, channel, step, values):
        return 2.0 * values if channel == "damper_force" else values

    def truth(self, channel, step, values):
        return 0.5 * values if channel == "damper_force" else values


class Raised(Doubled):
    """One that adds one to readings."""

    def reading(self, channel, step, values):
        return values + 1.0

    def truth(self, channel, step, values):
        return values - 1.0


TWICE = (Doubled(), Doubled())


def test_parts_are_changed_by_each_effect_in_turn():
    assert augment_plant(TWICE, PLANT_80) == PLANT_80._replace(driver_mass=320.0)
    assert augment_coil(TWICE, COIL) == COIL._replace(rate=520.0)
    assert augment_factors(TWICE, TemperatureFactors(viscous=-0.01)).viscous == -0.04
    assert augment_temperature(TWICE, 0.5, np.array([1.0])) == pytest.approx([2.0 * 2.5 + 0.5])


def test_readings_are_made_in_order_and_undone_in_the_opposite_one():
    effects, values = (Doubled(), Raised()), np.array([1.0, 4.0])
    both = read_sensors(effects, 0.1, {"damper_force": values, "coil_current": values})
    assert both["damper_force"] == pytest.approx([3.0, 9.0])
    assert undo_reading(effects, both["damper_force"], "damper_force", 0.1) == pytest.approx(values)
    assert both["coil_current"] == pytest.approx(values + 1.0)


ALL_ON_DAMPER = {find("effect", name) for name in names("effect") if acts_on(find("effect", name), ON_DAMPER)}
ALL_ON_SEAT = {find("effect", name) for name in names("effect") if acts_on(find("effect", name), ON_SEAT)}


def test_the_loop_carries_all_effects_of_a_side_where_one_is_at_work_or_all_where_it_is_asked():
    none = [effect("driver.mass", change=5.0)]
    assert select_in_loop(none) == ((), ())
    friction, seal = effect("suspension.friction", force=20.0), effect("damper.seal_friction", force=20.0)
    assert select_in_loop([friction])[0] == () == select_in_loop([seal])[1]
    for effects, carry_all in (([friction, seal], None), (none, True), ([friction], True)):
        on_damper, on_seat = select_in_loop(effects, carry_all)
        assert {type(each) for each in on_damper} == ALL_ON_DAMPER
        assert {type(each) for each in on_seat} == ALL_ON_SEAT
        assert all(each == off(type(each)) for each in (*on_damper, *on_seat) if each not in (friction, seal))
        assert (friction in on_seat) is (friction in effects)
    kinds = [tuple(map(type, side)) for side in select_in_loop(none, True)]
    assert kinds == [tuple(map(type, side)) for side in select_in_loop([friction, seal])]
    assert kinds[1] == tuple(map(type, select_in_loop([friction])[1]))


def test_a_second_effect_of_a_kind_is_carried_beside_the_first():
    first, second = (effect("suspension.friction", force=force) for force in (20.0, 30.0))
    on_seat = select_in_loop([first, second])[1]
    assert len(on_seat) == len(ALL_ON_SEAT) + 1 and {first, second} <= set(on_seat)
    assert on_seat[-1] is second


def test_a_damper_with_effects_has_their_state_behind_its_own():
    record = Bingham(250.0, 350.0, 45.0, 620.0)
    initial = specification_of(Bingham).initial
    assert augment_damper(record, ()) == (record, initial)
    remanence = effect("damper.remanence", width=0.1)
    damper, state = augment_damper(record, (remanence,))
    assert damper == AugmentedDamper(record, (remanence,))
    assert state == initial + specification_of(type(remanence)).initial
