"""Own classes are tried for an instant by `seatsim check`: each mistake is said by its place, a sound one passes."""

import numba
import pytest

DAMPER = """\
import math
from typing import Annotated, NamedTuple
from seatsim.dampers.base import damper
from seatsim.schema.fields import param

@damper("tried", source="a test", initial=(0.0,))
class Tried(NamedTuple):
    c: Annotated[float, param("N s/m", "damping", low=0, high=1e4)]
    a: Annotated[float, param("1/m", "rate of the state", low=0)] = 50.0
    def force(self, x, v, i, scaling, z):
        return self.c * scaling.viscous * v + 100.0 * (1.0 + i) * scaling.yield_force * z[0]
    def rates(self, x, v, i, scaling, z):
        return (self.a * (v - abs(v) * z[0]),)
"""
EFFECT = """\
from typing import Annotated, NamedTuple
from seatsim.effects.base import effect
from seatsim.schema.fields import param

@effect("cushion.tried", source="a test", forms=({"gap": 2e-4},))
class Tried(NamedTuple):
    gap: Annotated[float, param("m", "half of the dead band", low=0, high=0.01)]
    def cushion_force(self, force, plant, x, v, z):
        inside = min(max(x, -self.gap), self.gap)
        return force - plant.cushion_stiffness * inside
"""
LAW = """\
from typing import Annotated, NamedTuple
from seatsim.rig.control import law
from seatsim.schema.fields import param

@law("tried", source="a test")
class Tried(NamedTuple):
    on: Annotated[float, param("A", "current", low=0, high=2)]
    def wanted_current(self, y, state):
        return self.on if abs(y.velocity) > 0.1 else 0.0
"""
compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


@pytest.fixture
def check(tmp_path, seatsim_command, forget_own_code):
    """Write own code with one text in place of another, and check it: status and what was said."""

    def call(text, old="", new=""):
        assert old in text
        file = tmp_path / "tried.py"
        file.write_text(text.replace(old, new))
        status, out, err = seatsim_command("check", file)
        return status, out + err

    return call


@compiled
@pytest.mark.parametrize(
    ("text", "old", "new", "said"),
    [
        (DAMPER, "scaling.yield", "scaling.yielding", "tried.py, line 11: AttributeError: 'Temperature"),
        (DAMPER, "abs(v) *", "math.copysing(v, 1.0) *", "line 13: AttributeError: module 'math' has"),
        (DAMPER, "force(self, x, v, i, scaling, z)", "force(self, x, v, i, scaling)", "takes 5 positional"),
        (DAMPER, "return self.c * scaling", "return math.nan * scaling", "is no finite number"),
        (DAMPER, "z[0]),)", "z[0])+0.0)", "permitted: a tuple of 1, such as (0.0,)"),
        (DAMPER, "z[0]),)", "z[0]), 0.0)", "permitted: a tuple of 1, such as (0.0,)"),
        (
            EFFECT,
            "(self, force, plant, x, v, z)",
            "(self, plant, x, v, z)",
            "Tried.cushion_force(self, plant, x, v, z) is called with other arguments: too many positional arguments",
        ),
        (EFFECT, "plant.cushion_stiffness", "plant.kc", "10: cannot be compiled: unknown attribute 'kc' of type Plant"),
        (EFFECT, "return force - plant", "return 5.0 + force - plant", "tried: changes the rig where it is off"),
        pytest.param(EFFECT, '{"gap": 2e-4}', '{"gab": 2e-4}', "gab", marks=pytest.mark.slow),
        pytest.param(EFFECT, '{"gap": 2e-4}', '{"gap": 2.0}', "0.01", marks=pytest.mark.slow),
        (LAW, "y.velocity", "y.speed", "law tried: tried.py, line 9: cannot be compiled: unknown attribute 'speed'"),
        (LAW, "self.on if", "self.on + 'x' if", "line 9: cannot be compiled: add takes no (float64, Literal[str](x))"),
    ],
)
def test_a_mistake_is_said_before_a_run(text, old, new, said, check):
    status, found = check(text, old, new)
    assert status == 2 and said in found and found.count("error: ") == 1
    assert len(found.strip().splitlines()) == 1


def test_an_effect_without_forms_is_doubtful(check):
    status, said = check(EFFECT, ', forms=({"gap": 2e-4},)')
    assert status == 0 and "effect cushion.tried: without forms, no diagnosis tries it" in said


def test_a_field_without_a_default_is_tried_between_its_bounds(check):
    # Without an upper bound there is no middle, and 1 is tried.
    only_at_one = ("self.c * scaling", "(math.nan if self.c != 1.0 else 1.0) * scaling")
    assert check(DAMPER, *only_at_one)[0] == 2
    assert check(DAMPER.replace(", high=1e4", ""), *only_at_one)[0] == 0
