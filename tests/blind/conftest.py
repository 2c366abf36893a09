from __future__ import annotations

import pytest

from seatsim.blind.make import draw_experiment


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of a few seconds."""
    monkeypatch.setattr(draw_experiment, "SECONDS", 2.6)
    monkeypatch.setattr(draw_experiment, "UNSEEN_SECONDS", 2.6)
