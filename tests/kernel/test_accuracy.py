"""Figures of a run at default settings against independent solutions."""

import numpy as np
import pytest

from controllers.laws.skyhook import OnOffSkyhook
from controllers.laws.static_output_feedback import OutputFeedback
from seatsim.dampers.bingham import Bingham
from seatsim.dampers.bouc_wen import BoucWen, ModifiedBoucWen
from seatsim.effects.seat import Friction

from .references import Yielding, bouc_wen_feedback, channels, skyhook
from .rigs import deviations, driven, imbalance, refined, rough, run

GAIN = (2.0, 2147.6)
FEEDBACK = OutputFeedback(*GAIN)
CURRENT = 0.3
STEPPING = "Moreau time-stepping, written apart"


@pytest.fixture
def conforms(conform):
    """Hold the RMS values of a run and its balance of energy against a reference."""

    def check(claim, source, history, reference, tolerance):
        deviation = max(deviations(history, reference).values())
        conform(f"{claim}: greatest deviation of an RMS", source, deviation, tolerance=tolerance)
        missing = f"{claim}: share of the energy that is missing"
        conform(missing, "balance of energy", imbalance(history), tolerance=1e-4)

    return check


@pytest.mark.parametrize("every", [1, 5])
def test_feedback_through_a_bouc_wen_damper(every, conforms):
    floor = rough(2.0, rms=1.5)
    h = run(BoucWen(), FEEDBACK, floor, every=every)
    reference = bouc_wen_feedback(BoucWen(), floor, every, GAIN)
    conforms(f"Bouc-Wen, output feedback every {every} ms", "scipy, DOP853 at 1e-9", h, reference, 1e-3)


@pytest.mark.parametrize("every", [1, 5])
def test_feedback_through_a_modified_bouc_wen_damper(every, conforms):
    floor = rough(3.0, rms=1.5)
    h = run(ModifiedBoucWen(), FEEDBACK, floor, every=every)
    tight = run(ModifiedBoucWen(), FEEDBACK, refined(floor, 8), step=1.25e-4, every=8 * every, tolerance=1e-9)
    reference = {name: values[::8] for name, values in tight.items()}
    claim = f"modified Bouc-Wen, output feedback every {every} ms"
    conforms(claim, "seatsim with an eighth of the step, tolerance 1e-9", h, reference, 1e-3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_a_smooth_damper_at_constant_current(tolerance, conforms):
    floor = rough(3.0, rms=3.0)
    p = Yielding(250.0, 350.0, 45.0, 620.0, 0.1, 0.0)
    reference = channels(skyhook(p, floor, 1, 400, 130.0, -1.0, CURRENT))
    h = driven(Bingham(v_ref=0.1), floor, CURRENT, start_current=CURRENT, tolerance=tolerance)
    conforms(f"Bingham, v_ref 0.1 m/s, constant current, tolerance {tolerance:g}", STEPPING, h, reference, 1e-3)


@pytest.mark.parametrize("every", [1, 5])
@pytest.mark.parametrize(
    ("v_ref", "friction"), [(0.004, 0.0), (0.001, 0.0), (1e-4, 0.0), (0.0, 0.0), (0.0, 50.0), (0.004, 50.0)]
)
def test_a_switching_law_on_stiff_and_sticking_rigs(v_ref, friction, every, conforms):
    floor = rough(3.0, rms=3.0)
    p = Yielding(250.0, 350.0, 45.0, 620.0, v_ref, friction)
    reference = channels(skyhook(p, floor, every, 800, 130.0, 1.0, 0.0))
    h = run(Bingham(v_ref=v_ref), OnOffSkyhook(), floor, every=every, effects=(Friction(friction),))
    claim = f"on-off skyhook every {every} ms, v_ref {1e3 * v_ref:g} mm/s, linkage friction {friction:g} N"
    conforms(claim, STEPPING, h, reference, 1e-2)
    assert 0.05 < np.mean(h["current_command"]) < 0.95


@pytest.mark.parametrize(("v_ref", "friction"), [(0.001, 0.0), (0.0, 0.0), (0.0, 50.0), (0.004, 50.0)])
@pytest.mark.parametrize("rms", [1.5, 6.0])
def test_stick_and_slip_at_constant_current(v_ref, friction, rms, conforms):
    floor = rough(3.0, rms=rms, seed=1)
    p = Yielding(250.0, 350.0, 20.0, 300.0, v_ref, friction)
    reference = channels(skyhook(p, floor, 1, 800, 130.0, -1.0, CURRENT))
    damper = Bingham(fc_a=20.0, fc_b=300.0, v_ref=v_ref)
    h = driven(damper, floor, CURRENT, start_current=CURRENT, effects=(Friction(friction),))
    claim = f"stick-slip, floor {rms:g} m/s^2, v_ref {1e3 * v_ref:g} mm/s, linkage friction {friction:g} N"
    conforms(claim, STEPPING, h, reference, 1e-2)
    if v_ref == 0.0:
        assert 0.05 < np.mean(h["suspension_velocity"] == 0.0) < 0.95


def test_friction_that_vanishes_with_the_current(conforms):
    floor = rough(3.0, rms=3.0)
    reference = channels(skyhook(Yielding(250.0, 350.0, -50.0, 620.0, 0.0, 0.0), floor, 5, 800, 130.0, 1.0, 0.0))
    h = run(Bingham(fc_a=-50.0, v_ref=0.0), OnOffSkyhook(), floor, every=5)
    conforms("friction that vanishes with the current, on-off skyhook", STEPPING, h, reference, 1e-2)
