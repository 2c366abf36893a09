"""What own code gives is checked: one error names the class and where it went wrong, and no figure comes of it."""

import numpy as np
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
    how: float = 0.0
    def wanted_current(self, y, state):
        if self.how == 0.0 or y.time < 0.05:
            return 0.5
        return math.inf if self.how == 1.0 else math.nan

@law("bad_force")
class BadForce(NamedTuple):
    how: float = 0.0
    def wanted_force(self, y, state):
        if self.how == 0.0 or y.time < 0.05:
            return 100.0 * y.velocity
        return math.inf * y.velocity if self.how == 1.0 else math.nan

@damper("bad_damper", source="a test", current_order=1)
class BadDamper(NamedTuple):
    bad: float = 0.0
    def force(self, x, v, i, scaling, z):
        return 1000.0 * scaling.viscous * i * v if self.bad == 0.0 or abs(v) < 0.01 else (v - v) / (v - v)

@damper("bad_state", source="a test", initial=(0.0,), current_order=1)
class BadState(NamedTuple):
    bad: float = 0.0
    def force(self, x, v, i, scaling, z):
        return 300.0 * (1.0 + i) * v + z[0]
    def rates(self, x, v, i, scaling, z):
        return (0.0 if self.bad == 0.0 or abs(v) < 0.01 else math.nan,)

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


def rig(law, damper, how=0.0, bad=0.0, duration=1.0):
    """Return settings of a law and a damper; of each pair, which is right where its number is 0, a loop is compiled."""
    model = {"model": f"bad:{damper}", "parameters": {"bad": bad}}
    return {"controller": {"law": f"bad:{law}", "how": how}, "damper": model, "excitation.duration": duration}


PAIRS = pytest.mark.parametrize(("law", "damper"), [("BadCurrent", "BadDamper"), ("BadForce", "BadState")])


def test_own_damper_and_law_run_like_built_in_ones(bad, seat_file):
    own = seatsim.run(seat_file, rig("BadCurrent", "BadDamper", duration=3.0))
    np.testing.assert_array_equal(own["current_command"], 0.5)
    expected = 1000.0 * own["coil_current"] * own["suspension_velocity"]
    np.testing.assert_allclose(own["damper_force"], expected, atol=1e-9)
    assert np.max(np.abs(expected)) > 10.0


@PAIRS
@pytest.mark.parametrize("how", [1.0, 2.0])
def test_a_law_that_gives_no_number_is_named_with_the_time(bad, seat_file, law, damper, how):
    for duration in (1.0, 0.05):
        with pytest.raises(RunError, match=rf"\(bad:{law}\) gives no finite number at 0.05 s"):
            simulate(scenario(seat_file, rig(law, damper, how, duration=duration)))


@PAIRS
def test_a_damper_that_gives_no_number_is_named_with_its_motion(bad, seat_file, law, damper):
    with pytest.raises(RunError, match=rf"bad:{damper} gives no finite number at 0\.\d+ s, where x = .* v = -?0.01"):
        simulate(scenario(seat_file, rig(law, damper, bad=1.0)))


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


@pytest.mark.parametrize("short, words", [(1.0, r"shape \(7,\)"), (0.0, r"gives inf at sample 50, 0.05 s")])
def test_an_effect_that_gives_other_samples_is_named(bad, seat_file, short, words):
    effects = [{"effect": "bad:BadPush", "parameters": {"short": short}}]
    with pytest.raises(RunError, match=f"frame_force of the effect bad:BadPush.*{words}"):
        simulate(scenario(seat_file, {"effects": effects}))
