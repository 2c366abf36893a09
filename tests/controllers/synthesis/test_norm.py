"""The H-infinity norm against closed forms, and bisection against the grid."""

import numpy as np
import pytest
from scipy.linalg import block_diag

from controllers.synthesis import norm as module
from controllers.synthesis.norm import find_highest_norm, grid_norm, hinf_norm, largest_singular_values
from controllers.synthesis.plant import LinearSystem

METHODS = [hinf_norm, grid_norm]


def loop(A, B, C, D):
    return LinearSystem(*(np.array(matrix, dtype=float, ndmin=2) for matrix in (A, B, C, D)))


def random_loop(seed, n, nw, nz):
    random = np.random.default_rng(seed)
    A = random.standard_normal((n, n))
    A -= (np.linalg.eigvals(A).real.max() + 10 ** random.uniform(-3, 0)) * np.eye(n)
    D = random.standard_normal((nz, nw)) * random.integers(0, 2)
    return LinearSystem(A, random.standard_normal((n, nw)), random.standard_normal((nz, n)), D)


@pytest.mark.parametrize("norm", METHODS)
@pytest.mark.parametrize("damping", [1e-5, 1e-2, 0.3, 0.6])
def test_resonance(norm, damping, conform):
    oscillator = loop([[0, 1], [-4, -4 * damping]], [[0], [4]], [[1, 0]], 0)
    peak = norm(oscillator)
    value, frequency = 1 / (2 * damping * np.sqrt(1 - damping**2)), 2 * np.sqrt(1 - 2 * damping**2)
    claim = f"{norm.__name__} of an oscillator of 2 rad/s, damping {damping:g}"
    conform(claim, "1 / (2 D sqrt(1 - D^2))", peak.value, value, tolerance=1e-9 * value)
    claim = f"{claim}: frequency, rad/s"
    conform(claim, "omega0 sqrt(1 - 2 D^2)", peak.frequency, frequency, tolerance=1e-4 * frequency)


@pytest.mark.parametrize("norm", METHODS)
def test_peaks_at_the_ends(norm):
    assert norm(loop(-2, 1, 3, 0)) == pytest.approx((1.5, 0.0), abs=1e-6)
    assert norm(loop(-2, 1, -6, 3)) == pytest.approx((3.0, np.inf))


def test_no_effect_and_no_stability():
    assert hinf_norm(loop(-1, 0, 1, 0)).value == 0
    assert hinf_norm(loop([[0, 1], [-4, 0]], [[0], [1]], [[1, 0]], 0)) == pytest.approx((np.inf, 2.0))


def test_peak_hidden_behind_a_nearly_equal_end():
    # D alone reaches 1; a resonance at 1 rad/s reaches a little more while the poles tell of frequencies elsewhere.
    hidden = loop(np.diag([-300.0, -1e-3, -0.3]), [[300], [0], [0.3]], [[-1, 1, 0.05]], 1)
    assert hinf_norm(hidden).value == pytest.approx(grid_norm(hidden).value, rel=1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_bisection_agrees_with_the_grid(seed):
    some = random_loop(seed, n=2 + seed % 7, nw=1 + seed % 3, nz=1 + seed % 4)
    peak = hinf_norm(some)
    assert peak.value == pytest.approx(grid_norm(some).value, rel=1e-8)
    assert largest_singular_values(some, peak.frequency)[0] == pytest.approx(peak.value, rel=1e-10)


@pytest.mark.parametrize("rate", [1e-5, 1e5])
@pytest.mark.parametrize("seed", range(6))
def test_does_not_depend_on_the_unit_of_time(seed, rate):
    some = random_loop(seed, n=6, nw=2, nz=2)
    peak, moved = hinf_norm(some), hinf_norm(LinearSystem(rate * some.A, rate * some.B, some.C, some.D))
    assert moved.value == pytest.approx(peak.value, rel=1e-9)
    assert moved.frequency == pytest.approx(rate * peak.frequency, rel=1e-4)


def resonance(omega, damping, height):
    """A lag of the second order whose gain has its peak, of this height, where omega and damping put it."""
    gain = height * 2 * damping * np.sqrt(1 - damping**2)
    return loop([[0, omega], [-omega, -2 * damping * omega]], [[0], [omega * gain]], [[1, 0]], 0)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize("low", [0.5, 0.97, 0.99])
def test_the_higher_of_two_resonances_counts_where_the_poles_tell_of_the_lower(low, order):
    # At its pole the well damped one is 4 % below its peak, the sharp one nearly at it.
    both = [resonance(1.0, 0.01, low), resonance(1000.0, 0.5, 1.0)]
    joint = LinearSystem(*(block_diag(*(both[k][part] for k in order)) for part in range(4)))
    peak = hinf_norm(joint)
    assert peak.value == pytest.approx(1.0, rel=1e-9)
    assert peak.frequency == pytest.approx(1000.0 * np.sqrt(0.5), rel=1e-4)


@pytest.mark.parametrize("seed", range(10))
def test_of_several_loops_the_highest_is_found_and_one_above_enough_ends_the_search(seed):
    several = [random_loop(10 * seed + k, n=2 + k, nw=2, nz=2) for k in range(4)]
    norms = [grid_norm(each).value for each in several]
    worst, peak = find_highest_norm(several)
    assert (worst, peak.value) == (np.argmax(norms), pytest.approx(max(norms), rel=1e-8))
    place, above = find_highest_norm(several, enough=0.5 * max(norms))
    assert 0.5 * max(norms) < above.value <= norms[place] * (1 + 1e-9)


@pytest.mark.parametrize("rate", [1e-5, 1.0, 1e5])
def test_a_peak_that_is_barely_crossed_is_found_at_any_rate(rate):
    # The crossings of such a level are a double eigenvalue, which rounding moves off the axis.
    some = resonance(rate, 0.3, 1.0)
    for level in (1 - 1e-13, 1 + 1e-13):
        found = module._find_crossings(some, level)
        assert np.abs(found / (rate * np.sqrt(1 - 2 * 0.3**2)) - 1).min() < 1e-3
