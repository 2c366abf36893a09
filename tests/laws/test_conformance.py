"""What every law must do: run through clip, inverse and coil, on true states and on sensors, and compile."""

import numba
import numpy as np
import pytest

import seatsim
from controllers.laws.quadratic import Lqg, Lqr
from controllers.optimal import QuadraticWeights
from seatsim.kernel.generic import evaluate_law, update
from seatsim.rig.control import Measurement, prepare_law
from seatsim.schema.errors import SynthesisError

from ..part_space import check
from .records import COIL, LAWS, NOT_LINEAR, REQUIRED, SEAT, ready

WIDE = QuadraticWeights(travel=345.0, acceleration=67148.0, force=2e-9)
NOISY = {"displacement_noise": 1e-4, "acceleration_noise": 0.05}


def settings(law, sensors=None, seed=3):
    required = {k: list(v) if isinstance(v, tuple) else v for k, v in REQUIRED.get(law, {}).items()}
    controller = {"law": law, "sample_time": 0.005} | required | ({} if sensors is None else {"sensors": sensors})
    excitation = {"kind": "road", "road_class": "D", "speed": 12.0, "duration": 0.8}
    start, solver = {"displacement": 0.02}, {"step": 0.0025}
    return {"seed": seed, "controller": controller, "excitation": excitation, "start": start, "solver": solver}


@pytest.fixture(scope="module")
def passive(interpreted, kept_seat_file):
    """Driver RMS and travel of the softest or the stiffest passive damper, whichever is larger."""
    both = [settings("constant") | {"controller": {"law": "constant", "current": i}} for i in (0.0, 1.0)]
    return np.max([figures(seatsim.run(kept_seat_file, one).runs[0]) for one in both], axis=0)


def figures(run):
    return [run.metrics[name].value for name in ("driver_acceleration_rms", "suspension_displacement_peak")]


@pytest.mark.parametrize("sensors", [None, NOISY], ids=["true", "sensors"])
@pytest.mark.parametrize("law", LAWS)
def test_every_law_runs_within_its_limits(passive, kept_seat_file, law, sensors):
    run = seatsim.run(kept_seat_file, settings(law, sensors)).runs[0]
    command = run["current_command"]
    assert np.all((command >= 0.0) & (command <= 1.0))
    for name in ("driver_acceleration", "suspension_displacement", "damper_force", "coil_current"):
        assert np.all(np.isfinite(run[name])), name
    assert np.all(figures(run) < 1.5 * passive)


@pytest.mark.parametrize("law", NOT_LINEAR)
def test_laws_without_a_linear_loop_only_take_energy_from_a_released_seat(interpreted, kept_seat_file, law):
    rest = settings(law, {}) | {"excitation": {"kind": "rest", "duration": 1.0}}
    energy = seatsim.run(kept_seat_file, rest).runs[0]["energy_stored"]
    assert energy.max() <= energy[0] * (1 + 1e-9)
    assert energy[-1] < energy[0]


@pytest.mark.parametrize("law", LAWS)
def test_random_parameters_give_finite_answers_that_only_the_state_decides(law):
    found = check("law", law, 6, seed=1)
    assert set(found.counts) <= {"refused"}, found.cases


def test_weights_too_far_apart_are_refused():
    for law in (Lqr(WIDE), Lqg(WIDE)):
        with pytest.raises(SynthesisError, match=r"Riccati equation of the .* has no solution in numbers"):
            prepare_law(law, SEAT, COIL, 0.005)


@pytest.mark.parametrize("law", LAWS)
def test_compiled_and_interpreted_answers_agree(law):
    record, state = ready(law)
    answer = numba.njit(lambda law, y, s: (evaluate_law(law, y, s), update(law, y, s)))
    rng = np.random.default_rng(0)
    scale = [1, 0.02, 0.2, 0.2, 0.2, 1, 2, 2, 300, 0.5, 20, 1]
    for _ in range(20):
        y = Measurement(*(float(value) for value in scale * rng.standard_normal(12)))
        got, after = answer(record, y, state)
        assert got == pytest.approx(evaluate_law(record, y, state), rel=1e-9, abs=1e-9)
        state = update(record, y, state)
        np.testing.assert_allclose(after, state, rtol=1e-9, atol=1e-12)
