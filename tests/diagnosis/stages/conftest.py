"""The toy seat answers where the simulator would: no test here simulates or compiles anything."""

import pytest

from ...text import words
from .toy import NOMINAL, respond_linearly

SIMULATING = tuple(
    words("""
    seatsim.recordings.replay seatsim.diagnosis.problem seatsim.recordings.validation
    seatsim.diagnosis.localise.input_estimate seatsim.diagnosis.design.experiment
""")
)
"""Modules that simulate a rig."""


@pytest.fixture(autouse=True, scope="module")
def toy_seat():
    """Let the toy answer in every module that simulates, for the tests of one file."""
    with pytest.MonkeyPatch.context() as patch:
        for module in SIMULATING:
            patch.setattr(f"{module}.respond", respond_linearly)
        yield


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """A folder with the nominal scenario of the toy seat."""
    path = tmp_path_factory.mktemp("toy")
    (path / "nominal.yaml").write_text(NOMINAL)
    return path
