"""A user's own code does not stay for the tests that follow."""

import sys

import pytest

from seatsim.schema import modules, registry


@pytest.fixture
def forget_own_code(monkeypatch):
    """Forget at the end which files were used, their modules and what these registered."""
    registry.names("damper")
    monkeypatch.setattr(modules, "_used", {})
    monkeypatch.setattr(registry, "_classes", {kind: dict(known) for kind, known in registry._classes.items()})
    yield
    for name in modules._used:
        sys.modules.pop(name, None)
