"""Replays: a rig's own recording leaves no gap, recordings of others leave one that is well defined."""

import shutil

import numpy as np
import pandas as pd
import pytest

import seatsim
from seatsim.dampers.bouc_wen import BoucWen
from seatsim.recordings.gap import measure_gap
from seatsim.recordings.recording import load_recording
from seatsim.recordings.writer import save_recording
from seatsim.scenario.loading import single
from seatsim.simulation.damper_bench import bench_force

from ..text import words

CHANNELS = words("""
    floor_acceleration frame_acceleration driver_acceleration suspension_displacement damper_force
    current_command coil_current damper_temperature
""")
VARIANTS = {"feedback": {}, "switched": {"controller": {"law": "on_off_skyhook", "on": 0.6, "sample_time": 0.002}}}


@pytest.fixture(scope="module")
def result(kept_seat_file):
    return seatsim.run(kept_seat_file, {"variants": VARIANTS, "excitation.duration": 4.0})


@pytest.fixture(scope="module")
def kept(result, tmp_path_factory):
    return save_recording(result, tmp_path_factory.mktemp("kept") / "recorded", CHANNELS)


@pytest.fixture
def recorded(kept, tmp_path):
    return shutil.copytree(kept, tmp_path / "recorded")


@pytest.mark.parametrize(
    "absent", [[], ["damper_force"], ["coil_current"], ["current_command"], ["damper_temperature"]]
)
def test_the_replay_of_an_own_noiseless_recording_leaves_no_gap(result, tmp_path, absent, conform):
    folder = save_recording(result, tmp_path, [name for name in CHANNELS if name not in absent])
    claim = f"replay of an own noiseless recording{''.join(f' without {name}' for name in absent)}: overall gap"
    found = seatsim.gap(folder / "nominal.yaml", folder).overall
    conform(claim, "the simulation that was recorded", found, tolerance=1e-3)


def test_noise_is_added_as_it_is_stated(result, kept, tmp_path):
    noise = {"driver_acceleration": 0.05, "suspension_displacement": 2e-4}
    clean, noisy = load_recording(kept), load_recording(save_recording(result, tmp_path / "n", CHANNELS, noise=noise))
    assert {name: entry.noise_rms for name, entry in noisy.channels.items() if entry.noise_rms} == noise
    for run in clean.runs:
        added = {name: noisy.table(run)[name] - values for name, values in clean.table(run).items()}
        assert {name for name, values in added.items() if np.any(values)} == set(noise)
        assert all(np.std(added[name]) == pytest.approx(rms, rel=0.1) for name, rms in noise.items())


def test_the_gap_of_one_run_only(recorded):
    gap = seatsim.gap(recorded / "nominal.yaml", recorded, runs=["run-2"])
    assert gap.overall < 1e-3
    with pytest.raises(seatsim.InputError, match="did you mean 'run-2'"):
        seatsim.gap(recorded / "nominal.yaml", recorded, runs=["run-3"])


def test_a_table_that_is_not_there_is_named(recorded):
    (recorded / "run-1.csv.gz").unlink()
    with pytest.raises(seatsim.InputError, match=r"run-1\.csv\.gz: cannot be read: No such file"):
        seatsim.gap(recorded / "nominal.yaml", recorded)


def test_a_table_is_read_once_and_anew_after_an_edit_and_nothing_is_written_into_it(recorded):
    recording, path = seatsim.load_recording(recorded), recorded / "run-1.csv.gz"
    force = recording.table("run-1")["damper_force"]
    assert recording.table("run-1")["damper_force"] is force
    with pytest.raises(ValueError, match="read-only"):
        force[0] = 1.0
    pd.read_csv(path).assign(damper_force=7.0).to_csv(path, index=False)
    assert np.all(recording.table("run-1")["damper_force"] == 7.0)


FADING = {"damper.temperature_factors": {"viscous": -0.01, "yield_force": -0.01}}


@pytest.mark.parametrize(
    "settings",
    [
        # The largest step that divides the rows is taken.
        {"solver": {"step": 0.0007}},
        {"solver": {"step": 0.0005}},
        # A recorded temperature is an input of a damper that warms itself, too; a release test is no part of a replay.
        {"temperature": {"start": 80.0}, **FADING},
        {"start": {"displacement": 0.05}},
    ],
)
def test_what_a_recording_tells_stands_above_what_the_nominal_states(recorded, settings):
    assert seatsim.gap(single(recorded / "nominal.yaml", settings), recorded).overall < 1e-3


def test_a_constant_current_that_is_not_recorded_stands_in_the_nominal(kept_seat_file, result, tmp_path):
    constant = seatsim.run(kept_seat_file, {"controller": {"law": "constant", "current": 0.6}})
    folder = save_recording(constant, tmp_path / "constant", ["floor_acceleration", "driver_acceleration"])
    assert "current: 0.6" in (folder / "nominal.yaml").read_text()
    with pytest.raises(seatsim.InputError, match="must be recorded"):
        save_recording(result, tmp_path / "b", ["floor_acceleration", "driver_acceleration"])


def test_a_bench_recording_is_replayed_from_displacement_and_command(tmp_path):
    rows = np.arange(0.0, 6.0, 0.002)
    fine = np.arange(2 * len(rows) - 1) * 0.001
    omega = 2 * np.pi * 1.5
    force = bench_force(BoucWen(), 0.01 * np.sin(omega * fine), 0.01 * omega * np.cos(omega * fine), 0.6, 20.0, 0.002)
    frame = pd.DataFrame({"displacement": 0.01 * np.sin(omega * rows), "coil_current": 0.6, "damper_force": force})
    frame.to_csv(tmp_path / "a.csv", index=False)
    (tmp_path / "nominal.yaml").write_text(
        f"damper: {{model: bouc_wen, parameters: {BoucWen()._asdict()}}}\n"
        "actuator: {rate: 130.0, max_current: 1.0}\ntemperature: 20.0\n"
    )
    (tmp_path / "recording.yaml").write_text(
        "rig: damper_bench\nsample_rate: 500.0\nnominal: nominal.yaml\nruns: [{name: a, file: a.csv}]\n"
        "channels: {displacement: {unit: m}, coil_current: {unit: A}, damper_force: {unit: N, noise_rms: 2.0}}\n"
    )
    gap = seatsim.gap(tmp_path / "nominal.yaml", tmp_path)
    assert list(gap.channels) == ["damper_force"]
    assert gap.overall < 1e-3


def test_every_recording_of_an_independent_rig_can_be_replayed(shared):
    folders = sorted((shared / "field").glob("field-*"))
    gaps = [measure_gap(folder / "nominal.yaml", folder) for folder in folders]
    assert gaps
    for gap in gaps:
        assert 0 < gap.floor.overall < gap.overall < 2
