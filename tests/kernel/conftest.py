"""The kernel as plain Python."""

import pytest

from seatsim.kernel import step


@pytest.fixture
def uncompiled(monkeypatch):
    """The only function of the loop that is compiled apart, as plain Python."""
    monkeypatch.setattr(step, "_advance_divided", step._advance_divided.py_func)
