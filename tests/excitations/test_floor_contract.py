"""What every excitation owes: samples, start at rest, consistent derivatives, described keys, refusals."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from seatsim.excitations.iso7096 import Iso7096
from seatsim.excitations.periodic import Chirp, Sine, SteppedSine
from seatsim.excitations.road import Bumps, Road
from seatsim.schema.errors import InputError
from seatsim.schema.fields import adapter, describe
from seatsim.schema.registry import find, names, specification_of

from ..part_space import check

STEP = 0.001
BUMP = {"height": 0.05, "length": 1.0, "speed": 8, "duration": 6.0, "number": 2, "spacing": 12.0}
FALLING = {"start_frequency": 15, "stop_frequency": 1.0, "amplitude": 1.0, "duration": 10}
MAPPINGS = [
    (Road, {"road_class": "D", "speed": 12, "duration": 20}),
    (Road, {"road_class": "B", "speed": 20.0, "duration": 20.0, "through": "direct"}),
    (Road, {"road_class": "C", "speed": 1.5, "duration": 3.0}),
    (Iso7096, {"spectral_class": "EM3", "duration": 20}),
    (Sine, {"amplitude": 0.02, "frequency": 1.5, "duration": 10}),
    (SteppedSine, {"frequencies": [1, 2.5, 4.0], "cycles": 3, "amplitude": 0.01}),
    (Chirp, {"start_frequency": 0.5, "stop_frequency": 20, "amplitude": 0.001, "duration": 10}),
    (Chirp, {"quantity": "acceleration", **FALLING}),
    (Bumps, {"shape": "half_sine", **BUMP}),
    (Bumps, {"shape": "half_sine", "through": "direct", **BUMP}),
    (Bumps, {"shape": "haversine", **BUMP}),
    (Bumps, {"shape": "haversine", "through": "direct", **BUMP}),
]


def build(cls, mapping):
    return adapter(cls).validate_python(mapping)


@pytest.fixture(params=MAPPINGS, ids=lambda m: f"{m[0].__name__}-{MAPPINGS.index(m)}")
def made(request):
    return build(*request.param)


def test_a_floor_starts_at_rest_and_its_parts_are_integrals_without_drift(made):
    floor = made.floor(STEP, 3)
    count = round(made.duration / STEP) + 1
    assert floor.step == STEP
    assert [part.shape for part in floor[1:4]] == [(count,)] * 3
    assert all(part.dtype == np.float64 and np.isfinite(part).all() for part in floor[1:4])
    # The vehicle's tail wraps round by less than a millionth of the bump.
    assert max(abs(part[0]) / np.abs(part).max() for part in floor[1:4]) < 1e-5
    velocity = cumulative_trapezoid(floor.acceleration, dx=STEP, initial=0)
    displacement = cumulative_trapezoid(floor.velocity, dx=STEP, initial=0)
    assert np.abs(velocity - floor.velocity).max() < 0.01 * np.abs(floor.velocity).max()
    assert np.abs(displacement - floor.displacement).max() < 0.01 * np.abs(floor.displacement).max()


@pytest.mark.parametrize("name", ["bumps", "chirp", "iso7096", "rest", "road", "sine", "stepped_sine"])
def test_random_parameters_give_a_finite_floor_that_repeats_itself_at_any_step(name):
    found = check("excitation", name, 8, seed=1)
    assert set(found.counts) <= {"refused"}, found.cases


@pytest.mark.parametrize(("cls", "mapping"), [MAPPINGS[0], MAPPINGS[3]], ids=lambda v: getattr(v, "__name__", ""))
def test_another_seed_draws_another_motion(cls, mapping):
    made = build(cls, mapping)
    a, b = made.floor(STEP, 3).acceleration, made.floor(STEP, 4).acceleration
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.5


def test_too_coarse_a_step_is_refused_with_the_permitted_one(made):
    with pytest.raises(InputError, match=r"too coarse for its .* Hz; permitted: at most .* s; lower solver.step"):
        made.floor(0.5, 3)


@pytest.mark.parametrize("name", sorted(set(names("excitation")) - {"recording"}))
def test_every_key_is_described(name):
    cls = find("excitation", name)
    assert all(specification.meaning for specification in describe(cls))
    assert isinstance(specification_of(cls).source, str)


def test_a_run_of_less_than_two_steps_is_refused():
    with pytest.raises(InputError, match="fewer than two steps"):
        Sine(0.01, 2.0, 0.001).floor(STEP, 0)
