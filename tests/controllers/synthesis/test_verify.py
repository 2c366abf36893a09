"""What is said of a finished gain, against a frequency grid and closed forms."""

import numpy as np
import pytest

from controllers.synthesis import verify as module
from controllers.synthesis.norm import Peak
from controllers.synthesis.plant import GeneralisedPlant
from controllers.synthesis.verify import compute_verified_norm, disk_margin, verify

# Three lags 1 / (s + 1)^3 from u to y: with u = -k y stable up to k = 8.
A = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]])
B, C, NONE = np.array([[0.0], [0.0], [1.0]]), np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 1))
LAGS = GeneralisedPlant(A, B, B, C, C, NONE, NONE, NONE)
OMEGA = np.geomspace(1e-3, 1e3, 200_001)


def sensitivity(k):
    return 1 / (1 + k / (1 + 1j * OMEGA) ** 3)


@pytest.mark.parametrize("k", [0.5, 2.0, 7.0])
def test_figures_of_three_lags(k):
    found = verify(LAGS, np.array([[-k]]))
    T = np.abs(sensitivity(k) / (1 + 1j * OMEGA) ** 3)
    low = 1 / (1 + k)  # at zero frequency
    assert found.gamma == pytest.approx(max(T.max(), low), rel=1e-6)
    assert found.peak_frequency == pytest.approx(OMEGA[T.argmax()] if T.max() > low else 0.0, rel=1e-3, abs=2e-3)
    assert found.disk_margin == pytest.approx(2 / np.abs(2 * sensitivity(k) - 1).max(), rel=1e-6)
    assert found.norms_agree
    np.testing.assert_allclose(np.poly(found.poles), np.poly([-1, -1, -1]) + np.array([0, 0, 0, k]), rtol=1e-9)
    assert found.certificate.gamma == pytest.approx(found.gamma * (1 + found.certificate.delta))
    assert found.plant is LAGS


def test_the_disk_margin_is_where_a_factor_makes_the_loop_unstable():
    margin = disk_margin(LAGS, np.array([[-7.0]]))
    most = (2 + margin) / (2 - margin)
    assert 1.0 < most <= 8.0 / 7.0 * (1 + 1e-9)
    assert disk_margin(LAGS, NONE) == pytest.approx(2.0)


def test_the_larger_of_two_norms_counts(monkeypatch):
    loop = LAGS.close(np.array([[-2.0]]))
    right, agree = compute_verified_norm(loop)
    assert agree
    # A bisection that missed the peak is sent there by the grid; a grid far below it is told of.
    answers = iter([Peak(0.5 * right.value, 0.0), right])
    asked = []
    monkeypatch.setattr(module, "hinf_norm", lambda loop, guesses=(): asked.append(list(guesses)) or next(answers))
    found, agree = compute_verified_norm(loop)
    assert found == right and agree
    assert asked[0] == [] and asked[1] == pytest.approx([right.frequency], rel=1e-4)
    for size in (1e-3, 1.0, 1e3):
        norm = Peak(size * right.value, right.frequency)
        monkeypatch.setattr(module, "hinf_norm", lambda loop, guesses=(), norm=norm: norm)
        for factor, verdict in ((1 - 1e-7, True), (1 - 1e-5, False)):
            monkeypatch.setattr(module, "grid_norm", lambda loop, value=factor * norm.value: Peak(value, 1.0))
            assert compute_verified_norm(loop) == (norm, verdict)


@pytest.mark.parametrize(("excess", "searches"), [(-1e-8, 1), (0.0, 1), (1e-13, 1), (1e-8, 2)])
def test_a_grid_that_is_higher_by_rounding_alone_sends_no_second_search(monkeypatch, excess, searches):
    norm, asked = Peak(3.0, 1.0), []
    monkeypatch.setattr(module, "hinf_norm", lambda loop, guesses=(): asked.append(guesses) or norm)
    monkeypatch.setattr(module, "grid_norm", lambda loop: Peak(3.0 * (1.0 + excess), 1.0))
    assert compute_verified_norm(LAGS.close(NONE)) == (norm, True)
    assert len(asked) == searches
