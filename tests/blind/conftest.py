from __future__ import annotations

import pytest

from seatsim.blind.make import case


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of a few seconds."""
    monkeypatch.setattr(case, "SECONDS", 2.6)
    monkeypatch.setattr(case, "UNSEEN_SECONDS", 2.6)
