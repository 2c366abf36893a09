"""Every registered damper, found and built with its defaults."""

import pytest

from seatsim.schema.registry import find, names, specification_of

NAMES = names("damper")


@pytest.fixture(params=NAMES)
def cls(request):
    """The class of one registered damper after the other."""
    return find("damper", request.param)


@pytest.fixture
def model(cls):
    """The same with its default parameters."""
    return cls()


@pytest.fixture
def specification(cls):
    """What is stated of it."""
    return specification_of(cls)
