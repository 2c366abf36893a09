"""Two recordings of one rig as one: whose runs, channels and noise count, and what cannot be joined."""

import shutil

import numpy as np
import pytest

import seatsim
from seatsim.recordings.gap import measure_gap
from seatsim.recordings.quality.examination import examine
from seatsim.recordings.recording import join_recordings, load_recording

from ..faulty_recordings import edit
from ..text import words


def keep(run):
    """Return a change that leaves one run in a header."""
    return lambda header: header.update(runs=[each for each in header["runs"] if each["name"] == run])


@pytest.fixture
def pair(sound, tmp_path):
    """The first and the second run of a sound recording, a recording each; the second run is called as the first."""
    folders = [shutil.copytree(sound, tmp_path / name) for name in ("before", "later")]
    for folder, run in zip(folders, ("run-1", "run-2"), strict=True):
        edit(folder, keep(run))
    edit(folders[1], lambda header: header["runs"][0].update(name="run-1"))
    return folders


def join(pair, change=None, nominal=None):
    if change is not None:
        edit(pair[1], change)
    if nominal is not None:
        path = pair[1] / "nominal.yaml"
        path.write_text(path.read_text().replace(*nominal))
    return join_recordings(*map(load_recording, pair))


def test_the_runs_of_both_are_those_of_one(pair, sound):
    joined, said = join(pair)
    assert list(joined.runs) == ["run-1", "after-run-1"] and said == []
    whole = load_recording(sound)
    for run, name in (("run-1", "run-1"), ("after-run-1", "run-2")):
        for channel, values in whole.table(name).items():
            assert np.array_equal(joined.table(run)[channel], values)
    assert joined.folder == pair[0] and list(joined.channels) == list(whole.channels)
    assert not examine(joined).errors
    gap = measure_gap(sound / "nominal.yaml", whole)
    assert measure_gap(pair[0] / "nominal.yaml", joined).channels == pytest.approx(gap.channels)


def test_the_second_may_be_of_a_rig_that_was_changed_on_purpose(pair):
    joined, _ = join(pair, lambda header: header["runs"][0].update(set={"plant.driver_mass": 95.0}))
    nominal = seatsim.load(pair[0] / "nominal.yaml")[0]
    masses = [joined.scenario_of(run, nominal).plant.driver_mass for run in joined.runs]
    assert masses == [80.0, 95.0]


def test_a_repeat_goes_on_repeating_its_own_run(pair):
    again = {"name": "again", "file": "run-2.csv.gz", "repeat_of": "run-1"}
    joined, _ = join(pair, lambda header: header["runs"].append(again))
    assert joined.runs["again"].repeat_of == "after-run-1"


def test_channels_that_one_lacks_are_left_out_and_said(pair):
    joined, said = join(pair, lambda header: header["channels"].pop("damper_force"))
    assert "damper_force" not in joined.channels and "damper_force" not in joined.table("run-1")
    (sentence,) = said
    assert sentence.startswith("damper_force: left out, since later does not have it")


def test_what_differs_otherwise_is_said(pair):
    def change(header):
        header["channels"]["driver_acceleration"]["noise_rms"] = 0.5
        header.update(parameter_tolerance="fitted", model_error=0.1)

    joined, said = join(pair, change)
    assert joined.channels["driver_acceleration"].noise_rms == 0.5
    assert joined.header == load_recording(pair[0]).header
    changed = words("driver_acceleration parameter_tolerance model_error")
    assert [sentence.partition(":")[0] for sentence in said] == changed


def pop_currents(header):
    for name in ("current_command", "coil_current"):
        header["channels"].pop(name)


WRONG = [
    (lambda header: header.update(sample_rate=200.0), None, "sample_rate: 200.0 is not permitted beside"),
    (pop_currents, None, "has no current, and .* has coil_current and current_command; record one of them in both"),
    (None, ("driver_mass: 80.0", "driver_mass: 95.0"), "driver_mass: 95.0 is not permitted beside 80.0 of .*'set'"),
    (None, ("controller:", "effects: [{effect: driver.mass, parameters: {change: 3.0}}]\ncontroller:"), "other effect"),
]


@pytest.mark.parametrize(("change", "nominal", "problem"), WRONG)
def test_what_cannot_be_of_one_rig_is_refused(pair, change, nominal, problem):
    with pytest.raises(seatsim.InputError, match=problem) as raised:
        join(pair, change, nominal)
    assert str(raised.value).startswith(str(pair[1]))
