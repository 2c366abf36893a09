"""A law is designed by what it asks for, once, and one with notes is known by them."""

from typing import NamedTuple

from seatsim.rig.coil import Coil
from seatsim.rig.control import LawWithNotes, prepare_law
from seatsim.rig.plant import Plant

PLANT = Plant(20.0, 80.0, 4600.0, 150.0, 60000.0, 1500.0)
COIL = Coil(rate=130.0, max_current=1.0)


class ForPlant(NamedTuple):
    def prepared(self, plant):
        return ("prepared", plant)


class ForSampling(NamedTuple):
    def prepared(self, plant):
        raise AssertionError("the sampled form comes first")

    def sampled(self, plant, coil, sample_time):
        return ("sampled", plant, coil, sample_time)


class ForFloors(NamedTuple):
    def sampled(self, plant, coil, sample_time):
        raise AssertionError("the form for floors comes first")

    def on_floors(self, plant, coil, sample_time, floors):
        return ("on floors", floors())


class Plain(NamedTuple):
    gain: float = 1.0


class Talking(NamedTuple):
    def notes(self):
        return ("said",)


def test_a_law_is_prepared_by_the_richest_method_it_has():
    assert prepare_law(ForPlant(), PLANT, COIL, 0.005) == ("prepared", PLANT)
    assert prepare_law(ForSampling(), PLANT, COIL, 0.005) == ("sampled", PLANT, COIL, 0.005)
    assert prepare_law(ForFloors(), PLANT, COIL, 0.005, lambda: ["rough"]) == ("on floors", ["rough"])
    law = Plain()
    assert prepare_law(law, PLANT, COIL, 0.005) is law


def test_notes_are_those_of_the_law():
    assert isinstance(Talking(), LawWithNotes) and not isinstance(Plain(), LawWithNotes)
