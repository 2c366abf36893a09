"""The command line as a script calls it."""

import pytest


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time."""
    for picture in ("runs.draw.plot_result", "bench.characterisation.plot_characterisation"):
        monkeypatch.setattr(f"seatsim.plots.{picture}", lambda _: {})
