"""A sound recording that a test may edit, and its gap."""

import shutil

import pytest

import seatsim


@pytest.fixture(scope="session")
def sound_gap(sound):
    return seatsim.gap(sound / "nominal.yaml", sound)


@pytest.fixture
def copy(sound, tmp_path):
    return shutil.copytree(sound, tmp_path / "copy")
