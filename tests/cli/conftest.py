"""The command line as a script calls it."""

from contextlib import chdir

import pytest


@pytest.fixture
def here(tmp_path):
    """Work in an empty folder."""
    with chdir(tmp_path):
        yield tmp_path


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time."""
    monkeypatch.setattr("seatsim.plots.runs.draw.plot_result", lambda result: {})
