"""The examples that come along: all of them load, and a measured road takes the place of the generated one."""

from pathlib import Path

import pytest

import seatsim
from seatsim.pytest_plugin import _STATES_CHECKS
from seatsim.scenario.loading import load
from seatsim.scenario.numbers import list_doubts

FOLDER = Path(__file__).resolve().parents[2] / "scenarios"
FILES = [path for path in sorted(FOLDER.rglob("*.yaml")) if "data" not in path.parts]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_every_example_loads_without_doubt_and_says_what_it_is(path):
    scenarios = load(path)
    assert scenarios and not [doubt for scenario in scenarios for doubt in list_doubts(scenario)]
    assert path.read_text(encoding="utf-8").startswith("# ")


@pytest.mark.slow
@pytest.mark.parametrize(
    "path",
    [path for path in FILES if not _STATES_CHECKS.search(path.read_bytes())],
    ids=lambda path: str(path.relative_to(FOLDER)),
)
def test_every_example_runs_whose_checks_do_not_run_it(path, seatsim_command, tmp_path):
    status, _, said = seatsim_command("run", path, "--out", tmp_path / "out")
    assert status == 0, said


def test_the_shipped_recording_is_that_of_its_nominal_rig():
    folder = FOLDER / "data" / "recording"
    assert seatsim.gap(folder / "nominal.yaml", folder).overall < 1e-3
