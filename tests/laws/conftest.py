"""A time loop that needs no compiler."""

import pytest

import seatsim.simulation.simulate as simulation


@pytest.fixture(scope="module")
def interpreted():
    """The time loop as Python runs it: slow, but there is nothing to compile for a new combination."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulation, "compiled", lambda function, parts: function)
        yield
