"""The command line as a script calls it."""

import pytest


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time."""
    monkeypatch.setattr("seatsim.plots.runs.draw.plot_result", lambda result: {})
