"""Rigs of the preset `varied`: their ranges, their noise and floors, and that a faultless one replays."""

import gzip

import numpy as np
import pytest
from scipy.signal import welch

import seatsim
from seatsim.blind.make import draw_experiment
from seatsim.blind.make.make import encode_recording, recording_header, write_folder
from seatsim.blind.truth.excitation import NoiseColour, colour_noise, coloured_noise
from seatsim.blind.truth.experiment import CHANNELS, read_channels, simulate_run
from seatsim.blind.truth.faults import Changes
from seatsim.blind.truth.rig import INTEGRATION_STEP


def drawn(seed, bingham=False):
    return draw_experiment.draw_varied_experiment(np.random.default_rng(seed), bingham, CHANNELS)


@pytest.fixture(scope="module")
def rigs():
    """Rigs of every kind, at every rate."""
    return [drawn(seed, bingham) for seed in range(24) for bingham in (False, True)]


def test_parameters_lie_inside_the_stated_tolerance(rigs):
    assert {rig.sample_rate for rig in rigs} == set(draw_experiment.SAMPLE_RATES)
    assert 0.2 < np.mean([bool(rig.background) for rig in rigs]) < 0.5
    for rig in rigs:
        assert 0.01 <= rig.tolerance <= 0.05
        off = [rig.true[name] / value - 1.0 for name, value in rig.nominal.items() if value]
        assert 0.5 * rig.tolerance < np.max(np.abs(off)) <= 1.001 * rig.tolerance
        assert rig.true["damper_ratio"] == rig.nominal["damper_ratio"]
        names = ["run-a", "run-b", "run-c", *(["run-d"] if rig.background else []), "run-u"]
        assert [run.name for run in rig.runs] == names


@pytest.mark.parametrize(("rate", "n"), [(256.0, 1.0), (512.0, 2.0), (800.0, 0.0)])
def test_a_faultless_rig_of_any_kind_replays_to_within_its_noise(rigs, rate, n, tmp_path):
    found = (rig for rig in rigs if rig.sample_rate == rate and rig.nominal.get("n", 0.0) == n and not rig.background)
    experiment = next(found)
    experiment = experiment._replace(true=dict(experiment.nominal))
    shown = [read_channels(experiment, Changes(), k, simulate_run(experiment, Changes(), k)) for k in range(3)]
    write_folder(tmp_path / "case", encode_recording(experiment, shown, np.random.default_rng(0), range(3)))
    gap = seatsim.gap(tmp_path / "case" / "nominal.yaml", tmp_path / "case")
    # what is left beside noise is the floor's, between its rows and through its own accelerometer
    assert gap.overall < 1.5 * gap.floor.overall + 0.005


@pytest.mark.parametrize("rate", draw_experiment.SAMPLE_RATES)
def test_a_row_is_a_whole_number_of_steps(rigs, rate):
    experiment = next(rig for rig in rigs if rig.sample_rate == rate)
    motion = simulate_run(experiment, Changes(), 0)
    per_row = motion.fine_current.size / motion.frame.size
    assert per_row == int(per_row) and 1.0 / (rate * per_row) <= INTEGRATION_STEP * (1.0 + 1e-6)
    shown = [read_channels(experiment, Changes(), 0, motion)]
    files = encode_recording(experiment, shown, np.random.default_rng(0), [0])
    last = gzip.decompress(files["run-a.csv.gz"]).decode().splitlines()[-1]
    assert float(last.split(",")[0]) == pytest.approx((motion.frame.size - 1) / rate, abs=1e-9)
    header = recording_header(experiment, experiment.runs)
    assert (header["sample_rate"], header["parameter_tolerance"]) == (rate, experiment.tolerance)


def test_the_colour_of_a_noise():
    white = np.random.default_rng(0).standard_normal(400_000)
    colour = NoiseColour(flicker=0.2, corner=2.0, slow=0.4, bandwidth=20.0)
    noise = colour_noise(white, colour, 500.0)
    assert np.std(noise) == pytest.approx(1.0, rel=0.05)
    f, power = welch(noise, 500.0, nperseg=20_000)
    at = {hertz: np.mean(power[(f > 0.8 * hertz) & (f < 1.25 * hertz)]) for hertz in (0.1, 0.4, 8.0, 230.0)}
    assert at[230.0] == pytest.approx(0.4 / 250.0, rel=0.1)
    assert at[0.1] > 2.5 * at[0.4] > 5.0 * at[8.0] > 10.0 * at[230.0]
    plain = colour_noise(white, NoiseColour(0.0, 1.0, 0.0, 1.0), 500.0)
    np.testing.assert_allclose(plain, white, atol=1e-9)


def test_coloured_noise_has_unit_variance_and_its_slope():
    noise = coloured_noise(np.random.default_rng(0), 200_000, 0.5, 200.0, -1.0, 500.0)
    f, power = welch(noise, 500.0, nperseg=4096)
    assert np.std(noise) == pytest.approx(1.0)
    assert np.sqrt(power[f.searchsorted(4.0)] / power[f.searchsorted(16.0)]) == pytest.approx(4.0, rel=0.2)
    assert power[f > 61.0].max() < 1e-6 * power.max()
    half = coloured_noise(np.random.default_rng(0), 200_000, 0.5, 10.0, 0.0, 500.0)
    f, power = welch(half, 500.0, nperseg=4096)
    at = {
        hertz: np.mean(power[f.searchsorted(hertz - 0.3) : f.searchsorted(hertz + 0.3)]) for hertz in (3.0, 10.0, 20.0)
    }
    assert at[10.0] / at[3.0] == pytest.approx(0.5, rel=0.3)
    assert at[20.0] / at[3.0] == pytest.approx(1.0 / 257.0, rel=0.4)
