"""What inspect says of one file or a recording."""

import json

import numpy as np
import pytest
from ruamel.yaml import YAML

from seatsim.importing.inspection import inspect_file, inspect_recording
from seatsim.schema.content import to_content

from .helpers import kinds, write_csv


def test_figures_of_a_channel(noisy_table, tmp_path):
    found = inspect_file(write_csv(tmp_path / "a.csv", noisy_table))
    channels = {each.name: each for each in found.channels}
    force = channels["damper_force"]
    assert force.channel == "damper_force"
    assert force.rate == 500.0
    assert force.rows == 5001
    assert force.low == pytest.approx(np.min(noisy_table["damper_force"]))
    assert force.rms == pytest.approx(np.sqrt(np.mean(noisy_table["damper_force"] ** 2)))
    assert force.noise == pytest.approx(2.5, rel=0.15)
    assert channels["floor_acceleration"].noise == pytest.approx(0.01, rel=0.15)
    json.dumps(to_content(found))


def damaged(values, kind):
    values = values.copy()
    if kind == "missing":
        values[500:520] = np.nan
    elif kind == "held":
        values = np.repeat(values[::5], 5)[: len(values)]
    elif kind == "resolution":
        values = np.round(values / (0.1 * np.std(values))) * 0.1 * np.std(values)
    elif kind == "smooth":
        values = np.convolve(values, np.hanning(41) / np.sum(np.hanning(41)), "same")
    return values


@pytest.mark.parametrize("kind", ["missing", "held", "resolution", "smooth"])
def test_a_damaged_channel_is_doubted(noisy_table, tmp_path, kind, channel="driver_acceleration"):
    path = write_csv(tmp_path / "a.csv", {**noisy_table, channel: damaged(noisy_table[channel], kind)})
    assert kind in kinds(inspect_file(path).doubts, channel)


def test_rows_written_twice_copies_and_derived_velocities(noisy_table, tmp_path):
    rows = np.sort(np.append(np.arange(5001), [800, 801, 1500]))
    table = {name: values[rows] for name, values in noisy_table.items() if name != "time"}
    table["time"] = np.arange(5004) / 500.0
    table["frame_acceleration_2"] = table["frame_acceleration"]
    travel = np.convolve(noisy_table["suspension_displacement"], np.ones(9) / 9, "same")
    table |= {"stroke_m": travel[rows], "velocity_m_s": np.gradient(travel, 0.002)[rows]}
    found = kinds(inspect_file(write_csv(tmp_path / "a.csv", table)).doubts)
    assert {"repeated_rows", "duplicate", "derived"} <= found


def test_a_recording_is_examined(sound):
    found = inspect_recording(sound)
    header = YAML(typ="safe").load(sound / "recording.yaml")
    assert list(dict.fromkeys(each.group for each in found.channels)) == [run["name"] for run in header["runs"]]
    assert all(each.channel == each.name for each in found.channels)
