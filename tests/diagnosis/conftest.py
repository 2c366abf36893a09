"""A recording that all tests share."""

import pytest

from .damaged import healthy


@pytest.fixture(scope="session")
def sound(kept_seat_file, tmp_path_factory):
    """The folder of a healthy recording, which no test edits."""
    return healthy(kept_seat_file, tmp_path_factory.mktemp("sound") / "recorded")
