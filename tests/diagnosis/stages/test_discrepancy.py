"""What is said of an unexplained signal: tables of what comes from outside and of what drifts, and the words."""

import numpy as np
import pytest

from seatsim.diagnosis.localise.discrepancy import Discrepancy, describe_in_words, explain_signal, is_bias_drift
from seatsim.diagnosis.settings.examining import LocalisationSettings

from .toy import CHANNELS, RATE, SKIP, place, pose, record

SETTINGS = LocalisationSettings()


def found(signals, shares=None, block="suspension", channel=""):
    runs = dict(zip("abc", signals, strict=False))
    return Discrepancy(block, "force", "N", runs, shares or {"velocity": 0.1, "everything": 0.1}, channel)


def tone(frequency, rms=1.0, samples=2000):
    return rms * np.sqrt(2.0) * np.cos(2.0 * np.pi * frequency * np.arange(samples) / RATE)


@pytest.mark.parametrize(
    ("signals", "block", "drifts"),
    [
        ([tone(0.1)], "sensor", True),
        ([tone(0.5)], "sensor", True),
        ([tone(0.6)], "sensor", False),
        ([tone(0.1)], "suspension", False),
        ([np.ones(2000)], "sensor", True),
        # 0.95 and 0.85 of the power are slow.
        ([tone(0.2, np.sqrt(0.95)) + tone(3.0, np.sqrt(0.05))], "sensor", True),
        ([tone(0.2, np.sqrt(0.85)) + tone(3.0, np.sqrt(0.15))], "sensor", False),
        # The runs count together.
        ([tone(0.2, 2.0), tone(3.0, 0.5)], "sensor", True),
        ([tone(0.2, 1.0), tone(3.0, 0.5)], "sensor", False),
        # A run of half the length has bins of twice the width.
        ([tone(0.4, samples=1000)], "sensor", True),
        ([tone(0.6, samples=1000)], "sensor", False),
    ],
)
def test_what_is_slow_and_a_sensors_is_the_drift_of_its_zero(signals, block, drifts):
    assert is_bias_drift(SETTINGS, found(signals, block=block), RATE, 0.0) is drifts


def test_a_signal_of_its_own_does_not_swell_with_the_motion_as_what_a_wrong_law_leaves_does(folder):
    rng = np.random.default_rng(7)
    swells = {
        run: np.exp(np.sin(np.arange(SKIP + rows) / 150.0)) for run, rows in {"first": 4000, "second": 3000}.items()
    }
    floors = {run: rng.standard_normal(len(swell)) * swell for run, swell in swells.items()}
    problem = pose(record(folder, runs=floors, channels=CHANNELS[:4]))
    rig, wrong, own = place(problem), {}, {}
    for run, values in problem.measured.items():
        # Noise has no phase that a regressor could predict; a factor that differs by run is no sign of the motion.
        noise, swell = rng.standard_normal(values.shape[1]), swells[run][SKIP : SKIP + values.shape[1]]
        wrong[run], own[run] = noise * swell, noise * rng.uniform(1.0, 9.0)
    assert explain_signal(problem, rig, wrong)[1] > 0.5
    assert explain_signal(problem, rig, own)[1] < 0.1
    # A second has no changes of strength, nor has less, or what is not there.
    for rows, size in ((220, 1.0), (120, 1.0), (3000, 0.0)):
        other = pose(record(folder, runs={"only": rows}, channels=CHANNELS[:4]))
        signals = {"only": size * rng.standard_normal(other.measured["only"].shape[1])}
        assert explain_signal(other, place(other), signals)[1] == 0.0


def test_words_name_what_predicts_it_best_and_the_next_two():
    shares = {"displacement": 0.22, "velocity": 0.314, "past motion": 0.05, "floor motion": 0.12, "everything": 0.9}
    assert describe_in_words(found([3.0 * np.ones(5), 4.0 * np.ones(5)], shares)) == [
        "The unexplained force in the suspension has an RMS of 3.54 N.",
        "It follows velocity best, which predicts 31% of its power on runs left out.",
        "The displacement predicts 22% of it.",
        "The floor motion predicts 12% of it.",
    ]
