"""Sizes, severities, tolerance and files of drawn cases."""

import gzip
import io
import math

import numpy as np
import pandas as pd
import pytest

from seatsim.blind.make import cases, make, materiality
from seatsim.blind.make.materiality import ToleranceRefit
from seatsim.blind.truth.faults import Changes, SensorFault

from .experiments import small_experiment


@pytest.mark.parametrize("power", [1.0, 1.4, 1.7])
def test_a_severity_is_found_near_a_drawn_target(power):
    sizes, off = [], []
    for k in range(50):
        found = cases.find_severity(lambda s: 0.4 * s**power, (0.01, 1e3), np.random.default_rng(k))
        assert found is not None
        off.append(abs(math.log(found[1] / cases.draw_target(np.random.default_rng(k)))))
        assert found[1] == pytest.approx(0.4 * found[0] ** power)
        sizes.append(found[1])
    assert min(sizes) >= 1.03 and max(sizes) > 5.0
    assert np.quantile(off, 0.9) < cases.LOG_TOLERANCE


def test_materiality_of_a_gain_and_of_a_parameter():
    experiment, _, runs = small_experiment()
    gain = Changes(sensor_faults=(SensorFault("gain", "damper_force", 0.1),))
    size, response = runs.materiality(gain, Changes())
    force = np.concatenate([run["damper_force"][500:] for run in runs.read(Changes())])
    limit = max(0.05 * 1.1 * np.std(force), experiment.noise["damper_force"])
    assert size == pytest.approx(0.1 * materiality.rms(force) / limit)
    assert np.count_nonzero(response) <= force.size
    assert runs.materiality(Changes({"kf": -1e9}), Changes())[0] == math.inf
    double = Changes(sensor_faults=(SensorFault("gain", "damper_force", 0.2),))
    assert materiality.collinearity(response, runs.materiality(double, Changes())[1]) == pytest.approx(1.0)
    assert materiality.collinearity(np.array([1.0, 0.0]), np.array([-3.0, 4.0])) == pytest.approx(0.6)


def test_a_change_inside_the_tolerance_is_explained_and_one_beyond_it_is_not():
    experiment, _, runs = small_experiment()
    refit = ToleranceRefit(experiment, runs.commands)
    inside = Changes({"c_a": 250.0 * 1.015, "m": 80.0 * 1.015})
    far = Changes({"m": 80.0 * 1.3})
    assert refit.unexplained_share(inside, Changes()) < 0.1
    assert refit.unexplained_share(far, Changes()) > 0.5
    gain = Changes(sensor_faults=(SensorFault("gain", "damper_force", 1e-4),))
    assert refit.unexplained_share(gain, Changes()) == 1.0


def test_a_recording_holds_what_its_header_states():
    experiment, _, _ = small_experiment()
    quiet = {name: np.linspace(0.0, 1.0, 20_000) for name in make.CHANNELS}
    noisy = make.add_noise(experiment, quiet, np.random.default_rng(0))
    for name, noise in experiment.noise.items():
        assert np.std(noisy[name] - quiet[name]) == pytest.approx(noise, rel=0.03)
    np.testing.assert_array_equal(noisy["current_command"], quiet["current_command"])
    files = make.encode_recording(experiment, [quiet], np.random.default_rng(0), [0])
    assert sorted(files) == ["nominal.yaml", "recording.yaml", "run-a.csv.gz"]
    table = pd.read_csv(io.BytesIO(gzip.decompress(files["run-a.csv.gz"])))
    assert list(table.columns) == ["time", *make.CHANNELS]
    np.testing.assert_allclose(table["time"], np.arange(20_000) / 500.0)
    np.testing.assert_allclose(table["coil_current"], noisy["coil_current"], atol=6e-5)
    np.testing.assert_allclose(table["suspension_displacement"], noisy["suspension_displacement"], atol=6e-7)
    header = make.recording_header(experiment, experiment.runs[:1])
    assert header["channels"]["damper_force"] == {"unit": "N", "noise_rms": experiment.noise["damper_force"]}
    assert header["channels"]["current_command"] == {"unit": "A"}
    nominal = make.nominal_scenario(experiment)
    assert nominal["plant"]["suspension_stiffness"] == 4600.0 and nominal["actuator"]["rate"] == 130.0
    assert nominal["damper"]["parameters"]["alpha_b"] == 620.0 and nominal["damper"]["model"] == "bouc_wen"
