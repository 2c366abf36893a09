"""Recordings whose tables are in other units than SI."""

import shutil

import numpy as np
import pandas as pd
import pytest

from seatsim.recordings.recording import join_recordings, load_recording
from seatsim.schema.errors import InputError
from seatsim.schema.units import STANDARD_GRAVITY

from ..faulty_recordings import edit


@pytest.fixture(scope="module")
def in_other_units(sound, tmp_path_factory):
    """A copy of the sound recording whose driver's acceleration is in g, and its travel in mm."""
    folder = shutil.copytree(sound, tmp_path_factory.mktemp("units") / "recorded")
    for path in folder.glob("*.csv.gz"):
        frame = pd.read_csv(path)
        frame["driver_acceleration"] /= STANDARD_GRAVITY
        frame["suspension_displacement"] *= 1e3
        frame.to_csv(path, index=False, float_format="%.12g")

    def change(header):
        header["channels"]["driver_acceleration"] = {"unit": "g", "noise_rms": 0.01}
        header["channels"]["suspension_displacement"] = {"unit": "mm", "noise_rms": 0.05}

    edit(folder, change)
    return folder


def test_tables_and_noise_are_converted_on_reading(in_other_units, sound):
    found, expected = load_recording(in_other_units), load_recording(sound)
    for run in expected.runs:
        for name, values in expected.table(run).items():
            np.testing.assert_allclose(found.table(run)[name], values, rtol=1e-9, atol=1e-12)
    entry = found.channels["driver_acceleration"]
    assert entry.unit == "m/s^2"
    assert entry.noise_rms == pytest.approx(0.01 * STANDARD_GRAVITY)


def test_recordings_in_other_units_are_not_joined(in_other_units, sound):
    with pytest.raises(InputError, match=r"driver_acceleration\.unit: is another one"):
        join_recordings(load_recording(sound), load_recording(in_other_units))
