"""Effects in each of their forms: all that a record allows is there, sizes are scaled, and verdicts are judged."""

import pytest

from seatsim.blind.score.verdicts import Verdict
from seatsim.effects.base import EFFECTS
from seatsim.schema.registry import names


def test_every_parameter_of_an_effect_has_a_form_in_which_it_is_stated(benchmark):
    for name in names("effect"):
        forms = benchmark("typical_effects").FORMS[name]
        stated = {field for form in forms for field in (*form.sizes, *form.shape)}
        # The band and the phase of an unmeasured input change how it is made, and not what it is.
        left_out = {"low", "high", "phase"} if name == "floor.unmeasured_input" else set()
        assert stated == set(EFFECTS.find(name)._fields) - left_out, name


@pytest.mark.parametrize(
    ("verdict", "moved", "left", "right"),
    [
        (Verdict("known", selected=("coil.delay",)), 0.3, 0.2, True),
        (Verdict("ambiguous", selected=("coil.lag",), groups=(("coil.lag", "coil.delay"),)), 0.3, 0.2, True),
        (Verdict("known", selected=("coil.lag",)), 0.3, 0.2, False),
        (Verdict("unknown", selected=("coil.delay",)), 0.3, 0.2, False),
        (Verdict("none"), 0.3, 0.2, False),
        (Verdict("none"), 0.04, 0.2, True),
        (Verdict("none"), 0.3, 0.04, True),
        (Verdict("missing"), 0.01, 1.0, False),
    ],
)
def test_a_verdict_is_right_if_it_names_the_effect_or_nothing_material_is_left(benchmark, verdict, moved, left, right):
    module = benchmark("effect_forms")
    found = module.FoundForm(module.FormCase("coil.delay", 0, 1.0), verdict, moved, left, "")
    assert found.right is right
