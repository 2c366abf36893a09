"""What every registered effect fulfils; a new effect is tested by being registered."""

import math
from dataclasses import replace
from typing import NamedTuple

import pytest

from seatsim.blind.sealed import EFFECTS as CONTRACT
from seatsim.effects import base
from seatsim.effects.base import EFFECTS, off
from seatsim.scenario.scenario import Solver
from seatsim.schema.errors import InputError
from seatsim.schema.fields import adapter, bounds, choices, describe
from seatsim.schema.registry import find, specification_of
from seatsim.simulation.simulate import simulate

from ..part_space import check
from .rigs import NAMES, distance, shaken, starts

WITH_FORMS = [name for name in NAMES if starts(name)]


def at_rest(name):
    """The effect with all its parameters off, on each channel where it acts on one."""
    cls = find("effect", name)
    if specification_of(cls).by_channel:
        return [off(cls)._replace(channel=channel) for channel in choices(cls, "channel")]
    return [off(cls)]


def test_every_effect_of_the_contract_exists_and_lives_in_its_block():
    assert len(CONTRACT) == 24
    assert set(NAMES) >= set(CONTRACT)
    assert {name.partition(".")[0] for name in NAMES} <= {name.partition(".")[0] for name in CONTRACT}


@pytest.mark.parametrize("name", NAMES)
def test_every_field_is_described_and_off_and_every_start_can_be_written_in_a_scenario(name):
    cls = find("effect", name)
    assert specification_of(cls).source or name.startswith("sensor.")
    for field in describe(cls):
        assert field.meaning and (field.unit or field.name == "channel"), field.name
        assert field.name == "channel" or all(map(math.isfinite, bounds(cls, field.name))), field.name
    for effect in (*at_rest(name), *starts(name)):
        values = effect._asdict() | ({"channel": "damper_force"} if "channel" in effect._fields else {})
        assert adapter(cls).validate_python(values) == cls(**values)


def test_only_what_is_never_sought_has_no_form():
    assert set(NAMES) - set(WITH_FORMS) == {"floor.unmeasured_input"}


@pytest.fixture(scope="module", params=["bingham", pytest.param("bouc_wen", marks=pytest.mark.slow)])
def scenario(request):
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module")
def even(scenario):
    """The scenario in steps that are short enough never to be divided: there a rounding error decides nothing."""
    return replace(scenario, solver=Solver(2e-4, 1.0))


@pytest.fixture(scope="module")
def nominal(even):
    """The history of the rig that is compiled without any effect."""
    return simulate(even).channels


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_that_is_off_changes_nothing(even, nominal, name):
    assert distance(shaken(even, *at_rest(name)), nominal) < 1e-9


@pytest.mark.parametrize("name", WITH_FORMS)
def test_each_form_moves_a_channel_at_its_start(even, nominal, name):
    if not specification_of(find("effect", name)).suits(even.damper.record):
        pytest.skip("the damper has this of its own")
    for effect in starts(name):
        placed = effect._replace(channel="damper_force") if "channel" in effect._fields else effect
        assert distance(shaken(even, placed), nominal) > 1e-3, effect


@pytest.mark.parametrize("name", NAMES)
def test_random_parameters_give_finite_runs_that_a_shorter_run_begins(name):
    found = check("effect", name, 4, seed=1)
    assert set(found.counts) <= {"open", "refused"}, found.cases


def test_the_order_of_effects_does_not_matter(bingham):
    effects = [starts(name)[0] for name in WITH_FORMS if not name.startswith("sensor.")]
    assert distance(shaken(bingham, *effects), shaken(bingham, *effects[::-1])) < 1e-12


def test_a_method_that_is_no_hook_is_refused_with_the_nearest_hook():
    class Push(NamedTuple):
        size: float = 0.0

        def frame_forces(self, time, seed):
            return self.size * time

    with pytest.raises(InputError, match=r"effect 'floor.push': method 'frame_forces' is no hook.*'frame_force'"):
        base.effect("floor.push")(Push)
    assert "floor.push" not in EFFECTS.names()
