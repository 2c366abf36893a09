"""Fields of records: what is stated once is read by descriptions, bounds and validation."""

import math
from typing import Annotated, Literal, NamedTuple

import pytest
from pydantic import ValidationError

from seatsim.schema.fields import SLIGHTLY, bounds, choices, default_values, describe, field_names, param, validated


class Spring(NamedTuple):
    stiffness: Annotated[float, param("N/m", "spring stiffness", above=0)]
    preload: Annotated[float, param("N", "force at rest", low=-10, high=50)] = 5.0


class Mount(NamedTuple):
    side: Annotated[Literal["left", "right"], param("-", "where it stands")] = "left"


def test_a_description_has_unit_meaning_and_default():
    stiffness, preload = describe(Spring)
    (side,) = describe(Mount)
    assert stiffness[:5] == ("stiffness", "N/m", "spring stiffness", None, True)
    assert preload[:5] == ("preload", "N", "force at rest", 5.0, False)
    assert (side.unit, side.default) == ("-", "left")


def test_bounds_are_those_stated_and_an_open_one_is_just_inside():
    assert bounds(Spring, "preload") == (-10.0, 50.0)
    assert bounds(Spring, "stiffness") == (SLIGHTLY, math.inf)
    assert 0.0 < SLIGHTLY < 1e-6


def test_names_defaults_and_choices():
    assert field_names(Spring) == ("stiffness", "preload")
    assert default_values(Spring) == {"preload": 5.0}
    assert choices(Mount, "side") == ("left", "right")
    assert field_names(int) == () and default_values(int) == {}


def test_validation_gives_the_record_or_refuses():
    assert validated(Spring, {"stiffness": 2, "preload": 50}) == Spring(2.0, 50.0)
    for wrong in ({"stiffness": 0.0}, {"stiffness": 1.0, "preload": 50.1}, {"stiffness": "1.0"}, {}):
        with pytest.raises(ValidationError):
            validated(Spring, wrong)
