"""A sound recording that a test may edit."""

import shutil

import pytest


@pytest.fixture
def copy(sound, tmp_path):
    return shutil.copytree(sound, tmp_path / "copy")
