"""Effects in each of their forms: all that a record allows is there, sizes are scaled, and verdicts are judged."""

from seatsim.effects.base import EFFECTS
from seatsim.schema.registry import names


def test_every_parameter_of_an_effect_has_a_form_in_which_it_is_stated(benchmark):
    for name in names("effect"):
        forms = benchmark("typical_effects").FORMS[name]
        stated = {field for form in forms for field in (*form.sizes, *form.shape)}
        # The band and the phase of an unmeasured input change how it is made, and not what it is.
        left_out = {"low", "high", "phase"} if name == "floor.unmeasured_input" else set()
        assert stated == set(EFFECTS.find(name)._fields) - left_out, name
