"""What is said of a finished gain, against a frequency grid and closed forms."""

import numpy as np
import pytest

from controllers.synthesis.design import verify
from controllers.synthesis.plant import GeneralisedPlant

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
