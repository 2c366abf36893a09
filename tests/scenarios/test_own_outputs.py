"""What own code gives is checked: one error names the class and where it went wrong, and no figure comes of it."""

import pytest

import seatsim
from seatsim.scenario.loading import load
from seatsim.schema.errors import RunError
from seatsim.simulation.simulate import simulate

CODE = """
import math
from typing import NamedTuple
import numpy as np
from seatsim.dampers.base import damper
from seatsim.effects.base import effect
from seatsim.excitations.base import Floor, excitation
from seatsim.rig.control import law

@law("bad_current")
class BadCurrent(NamedTuple):
    infinite: float
    def wanted_current(self, y, state):
        return 0.5 if y.time < 0.05 else (math.inf if self.infinite > 0.0 else math.nan)

@law("bad_force")
class BadForce(NamedTuple):
    infinite: float
    def wanted_force(self, y, state):
        return 100.0 * y.velocity if y.time < 0.05 else (math.inf * y.velocity if self.infinite > 0.0 else math.nan)

@damper("bad_damper", source="a test", current_order=1)
class BadDamper(NamedTuple):
    c: float = 300.0
    def force(self, x, v, i, scaling, z):
        return self.c * v if abs(v) < 0.01 else (v - v) / (v - v)

@damper("bad_state", source="a test", initial=(0.0,), current_order=1)
class BadState(NamedTuple):
    c: float = 300.0
    def force(self, x, v, i, scaling, z):
        return self.c * v + z[0]
    def rates(self, x, v, i, scaling, z):
        return (0.0 if abs(v) < 0.01 else math.nan,)

@excitation("bad_floor")
class BadFloor(NamedTuple):
    how: str
    def floor(self, step, seed):
        a = np.sin(0.02 * np.arange(500))
        if self.how == "nothing":
            return None
        if self.how == "another step":
            return Floor(2.0 * step, a, a, a)
        if self.how == "one sample":
            return Floor(step, a[:1], a[:1], a[:1])
        if self.how == "NaN":
            return Floor(step, np.where(a > 0.9, np.nan, a), a, a)
        if self.how == "text":
            return Floor(step, a, np.array(["x"] * 500), a)
        if self.how == "list":
            return Floor(step, list(a), a, a)
        return Floor(step, a, a[:100], a) if self.how == "short velocity" else Floor(step, a, a, a, command=a[:7])

@effect("floor.bad_push", source="a test")
class BadPush(NamedTuple):
    short: float
    def frame_force(self, time, seed):
        return np.ones(7) if self.short > 0.0 else np.where(time < 0.05, 1.0, np.inf)
"""


@pytest.fixture(scope="module")
def bad_file(tmp_path_factory):
    """A file whose classes give what they must not: one for all tests, so that a loop is compiled once."""
    file = tmp_path_factory.mktemp("bad") / "bad.py"
    file.write_text(CODE)
    return file


@pytest.fixture
def bad(bad_file, forget_own_code):
    """The classes of that file."""
    seatsim.use(bad_file)


def scenario(seat_file, settings):
    return load(seat_file, {"excitation.duration": 1.0, **settings} if "excitation" not in settings else settings)[0]


@pytest.mark.parametrize("law", ["BadCurrent", "BadForce"])
@pytest.mark.parametrize("infinite", [0.0, 1.0])
def test_a_law_that_gives_no_number_is_named_with_the_time(bad, seat_file, law, infinite):
    run = scenario(seat_file, {"controller": {"law": f"bad:{law}", "infinite": infinite}})
    words = rf"\(bad:{law}\) gives no finite number at 0.05 s"
    with pytest.raises(RunError, match=words):
        simulate(run)
    cut = scenario(seat_file, {"controller": {"law": f"bad:{law}", "infinite": infinite}, "excitation.duration": 0.05})
    with pytest.raises(RunError, match=words):
        simulate(cut)


@pytest.mark.parametrize("damper", ["BadDamper", pytest.param("BadState", marks=pytest.mark.slow)])
def test_a_damper_that_gives_no_number_is_named_with_its_motion(bad, seat_file, damper):
    with pytest.raises(RunError, match=rf"bad:{damper} gives no finite number at 0\.\d+ s, where x = .* v = -?0.01"):
        simulate(scenario(seat_file, {"damper": {"model": f"bad:{damper}"}}))


@pytest.mark.parametrize(
    "how, words",
    [
        ("short velocity", r"the velocity of .*bad:BadFloor gives an array of shape \(100,\)"),
        ("short command", r"the command of .*bad:BadFloor gives an array of shape \(7,\)"),
        ("NaN", r"the acceleration of .*bad:BadFloor gives nan at sample \d+, 0.0\d+ s"),
        ("nothing", "bad:BadFloor gives NoneType"),
        ("another step", "gives 500 samples every 0.002 s"),
        ("one sample", "gives 1 samples"),
        ("text", "the velocity of .* not an array of numbers"),
    ],
)
def test_a_floor_that_compiled_code_cannot_read_is_refused(bad, seat_file, how, words):
    with pytest.raises(RunError, match=words):
        simulate(scenario(seat_file, {"excitation": {"kind": "bad:BadFloor", "how": how}}))


def test_a_floor_of_lists_is_one_of_arrays(bad, seat_file):
    found = simulate(scenario(seat_file, {"excitation": {"kind": "bad:BadFloor", "how": "list"}}))
    assert len(found["time"]) == 500


@pytest.mark.parametrize("short, words", [(1.0, r"shape \(7,\)"), (0.0, r"gives inf at sample 50, 0.05 s")])
def test_an_effect_that_gives_other_samples_is_named(bad, seat_file, short, words):
    effects = [{"effect": "bad:BadPush", "parameters": {"short": short}}]
    with pytest.raises(RunError, match=f"frame_force of the effect bad:BadPush.*{words}"):
        simulate(scenario(seat_file, {"effects": effects}))
