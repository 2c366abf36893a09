"""What a damper can do, from its steady forces at several speeds and currents."""

import numpy as np
import pytest

from controllers.clairvoyant import bound as module
from controllers.clairvoyant.bound import SPEEDS, fit_envelope
from controllers.clairvoyant.recursion import ForceBand
from seatsim.schema.errors import InputError


@pytest.fixture
def steady(monkeypatch):
    """Set the steady force of a damper by a function of speed and current; both ways alike unless it gives two."""

    def use(force):
        def measured(damper, speed, current, temperature):
            return np.broadcast_to(np.asarray(force(speed, current), dtype=float), (2,))

        monkeypatch.setattr(module, "_measure_steady_force", measured)

    return use


def test_the_largest_current_counts(steady):
    steady(lambda w, i: 45.0 + 620.0 * i + (250.0 + 350.0 * i) * w)
    assert fit_envelope(None, 2.0, 20.0).inner == pytest.approx(ForceBand(250.0, 45.0, 950.0, 1285.0), rel=1e-9)


def test_bent_and_lopsided_forces_lie_between_the_outer_lines_and_hold_the_inner_ones(steady):
    def force(w, i):
        base = 60.0 + 200.0 * w + 80.0 * np.sqrt(w) + i * (500.0 + 300.0 * np.sqrt(w))
        return base, 1.1 * base

    steady(force)
    inner, outer = fit_envelope(None, 1.0, 20.0)[::-1]
    least = np.array([force(w, 0.0) for w in SPEEDS])
    most = np.array([force(w, 1.0) for w in SPEEDS])
    w = SPEEDS[:, None]
    assert np.all(outer.f + outer.c * w <= least + 1e-9) and np.min(least - outer.f - outer.c * w) < 1e-9
    assert np.all(inner.f + inner.c * w >= least - 1e-9) and np.min(inner.f + inner.c * w - least) < 1e-9
    assert np.all(inner.a + inner.b * w <= most + 1e-9) and np.min(most - inner.a - inner.b * w) < 1e-9
    # The strip abs(F - b w) <= a holds every force, and no other slope up to the inner line's makes a narrower one.
    width = {b: max((most - b * w).max(), (b * w - least).max()) for b in np.linspace(0.0, inner.b, 901)}
    assert outer.a == pytest.approx(max((most - outer.b * w).max(), (outer.b * w - least).max()), rel=1e-12)
    assert outer.a <= min(width.values()) * 1.01
    assert outer.c >= 0.0 and inner.b >= 0.0


def test_what_has_no_envelope(steady):
    steady(lambda w, i: (45.0 - 60.0, 45.0 + 60.0) if w < 0.15 else (100.0, 100.0))
    with pytest.raises(InputError, match=r"drives instead of damping at 0.02 m/s"):
        fit_envelope(None, 1.0, 20.0)
    steady(lambda w, i: 45.0 + 250.0 * w)
    with pytest.raises(InputError, match="do not leave a straight band"):
        fit_envelope(None, 1.0, 20.0)
