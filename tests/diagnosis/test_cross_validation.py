"""Where the nominal's own form is wrong everywhere: which effects runs left out of the fit support."""

import numpy as np
import pandas as pd
import pytest

import seatsim

RATE = 250.0
NOMINAL = """\
damper:
  model: bouc_wen
  parameters: {c_a: 900.0, c_b: 1800.0, alpha_a: 90.0, alpha_b: 700.0, A: 2.0e+4, beta: 1.0e+4, gamma: 1.0e+4, n: 2.0,
               k0: 0.0, x0: 0.0, f0: 0.0}
actuator: {rate: 130.0, max_current: 1.0}
temperature: 20.0
"""
HEADER = """\
rig: damper_bench
sample_rate: 250.0
parameter_tolerance: 0.1
nominal: nominal.yaml
runs: [{name: slow, file: slow.csv}, {name: middle, file: middle.csv}, {name: fast, file: fast.csv}]
channels: {displacement: {unit: m, noise_rms: 1.0e-6}, current_command: {unit: A},
           damper_force: {unit: N, noise_rms: 2.0}}
"""


def force(x, v, current, preload):
    """Return the force of a damper with a preload whose loop is wider than any of the nominal's at large travel."""
    yielding = 90.0 + 650.0 * current**1.3
    return preload + 1100.0 * np.sign(v) * np.abs(v) ** 0.8 + yielding * np.tanh((v + 3.0 * x) / 0.02)


@pytest.fixture
def folder(tmp_path):
    """Write a recording of a damper of another form than its nominal, with a gas preload of 60 N."""
    rng, time = np.random.default_rng(4), np.arange(0.0, 8.0, 1.0 / RATE)
    for name, frequency, current in (("slow", 0.7, 0.1), ("middle", 1.3, 0.3), ("fast", 2.1, 0.0)):
        phase = 2.0 * np.pi * frequency * time
        x = 0.01 * np.sin(phase) + 0.003 * np.sin(2.7 * phase)
        v = 2.0 * np.pi * frequency * (0.01 * np.cos(phase) + 0.0081 * np.cos(2.7 * phase))
        read = force(x, v, current, 60.0) + 2.0 * rng.standard_normal(len(time))
        columns = {"displacement": x, "current_command": current, "damper_force": read}
        pd.DataFrame(columns).to_csv(tmp_path / f"{name}.csv", index=False)
    (tmp_path / "recording.yaml").write_text(HEADER)
    (tmp_path / "nominal.yaml").write_text(NOMINAL)
    return tmp_path


@pytest.mark.slow
def test_a_known_effect_is_named_beside_a_form_that_is_wrong_everywhere(folder):
    found = seatsim.diagnose(folder)
    assert found.verdict == "unknown"
    assert "damper.gas_spring" in found.selected
    assert found.gap.shrink > 0.1
    # The current of a limit stands for the curve of the yield force over current, which the nominal has as a line.
    assert found.sentence.startswith(tuple(found.selected)) and "no effect of the library explains" in found.sentence
    assert all(f"{first} from {' and '.join(others)}" in found.sentence for first, *others in found.indistinguishable)
    (cause,) = [cause for cause in found.causes if cause.effect == "damper.gas_spring"]
    assert cause.parameters["preload"].value == pytest.approx(60.0, rel=0.3)
