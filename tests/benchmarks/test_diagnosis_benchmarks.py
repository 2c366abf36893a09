"""The benchmarks of the diagnosis: what they replace, what they feed a rig with, and how they count."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from seatsim.diagnosis.problem import pose_problem
from seatsim.diagnosis.settings.diagnosis_settings import DiagnosisSettings
from seatsim.diagnosis.solution import Method
from seatsim.effects.sensor import Gain
from seatsim.recordings.recording import load_recording


@pytest.fixture(scope="module")
def problem(sound):
    with ThreadPoolExecutor(2) as pool:
        yield pose_problem(load_recording(sound), pool)


def test_an_ablation_takes_one_part_away_and_leaves_the_others(benchmark):
    parts, full = benchmark("diagnosis_ablations").PARTS, DiagnosisSettings()
    assert parts["material"].settings == full._replace(decision=full.decision._replace(material=0.0))
    assert parts["null"].settings == full._replace(noise=full.noise._replace(model_error=0.0))
    assert [name for name, part in parts.items() if part.settings == full] == [
        "blocks", "nuisance", "instruments", "whitening",
    ]  # fmt: skip
    assert [name for name, part in parts.items() if not part.vary_parameters] == ["nuisance"]
    replaced = {name: [stage for stage, own, usual in zip(Method._fields, part.method, Method(), strict=True)
                       if own is not usual] for name, part in parts.items()}  # fmt: skip
    assert replaced == {
        "blocks": ["share_gap"], "nuisance": [], "instruments": ["select_effects", "decide_verdict"],
        "null": ["decide_verdict"], "material": [], "whitening": ["weigh_noise"], "shortcuts": [],
    }  # fmt: skip


def test_stated_noise_alone_whitens_white_noise_of_that_size_to_mean_square_1(benchmark, problem):
    weights = benchmark("cases").weigh_stated_noise(problem)
    level = np.maximum(problem.noise, 1e-3 * problem.spread)[:, None]
    run, rng = problem.runs[0], np.random.default_rng(1)
    whitened = weights(level * rng.standard_normal(problem.measured[run].shape), run)
    assert np.mean(whitened**2) == pytest.approx(1.0, abs=0.05)


def test_a_rig_fed_its_own_motion_moves_as_the_recorded_one(benchmark, problem):
    """The recorded rig is the nominal one: the equation of its frame holds, but for what noise is differentiated."""
    fed = benchmark("measured_motion").simulate_fed(problem, problem.runs[0], problem.nominal, ())
    error = fed - problem.measured[problem.runs[0]]
    assert np.all(np.std(error, axis=1) < 0.1 * problem.spread)


def test_what_a_wrong_sensor_reads_is_undone_before_it_is_fed(benchmark, problem):
    """A cell that is 20 % too sensitive is undone before its force enters the frame's equation, and read again."""
    run, module = problem.runs[0], benchmark("measured_motion")
    cell, frame = (problem.channels.index(name) for name in ("damper_force", "frame_acceleration"))
    plain = module.simulate_fed(problem, run, problem.nominal, ())
    wrong = module.simulate_fed(problem, run, problem.nominal, (Gain("damper_force", 0.2),))
    settled = round(problem.rate)
    force, mass = problem.measured[run][cell], module.vary_plant(problem, problem.nominal).frame_mass
    assert wrong[cell][settled:] == pytest.approx(1.2 * plain[cell][settled:])
    assert (wrong - plain)[frame][settled:] == pytest.approx((force - force / 1.2)[settled:] / mass, rel=1e-6)


def test_fed_residuals_are_measured_less_simulated(benchmark, problem):
    module, run = benchmark("measured_motion"), problem.runs[0]
    fed = module.feed_problem(problem).on_runs([run])
    expected = problem.measured[run] - module.simulate_fed(problem, run, problem.nominal, ())
    assert np.array_equal(fed.residuals([(problem.nominal, ())])[0][run], expected)


def test_a_calibrated_sensor_leaves_nothing_to_name_and_another_effect_must_be_named_alone(benchmark):
    is_separated = benchmark("diagnosis_experiments").is_separated

    def outcome(effect, reason, verdict, selected):
        return {"effects": [effect], "experiment": {"reason": reason}, "second": {
            "verdict": verdict, "selected": selected}}  # fmt: skip

    assert is_separated(outcome("sensor.gain", "calibrating it", "none", []))
    assert not is_separated(outcome("sensor.gain", "calibrating it", "known", ["sensor.gain"]))
    assert is_separated(outcome("coil.lag", "calibrating it", "known", ["coil.lag"]))
    assert is_separated(outcome("sensor.gain", "shake it", "known", ["sensor.gain"]))
    assert not is_separated(outcome("coil.lag", "shake it", "known", ["coil.lag", "coil.delay"]))
    assert not is_separated(outcome("coil.lag", "shake it", "ambiguous", ["coil.lag"]))


def test_effects_are_ranked_by_their_largest_figure(benchmark):
    ranked = benchmark("cases").rank_by_figure([("a", 1.0), ("b", 3.0), ("a", 2.0), ("c", 2.5)])
    assert ranked == [("b", 3.0), ("c", 2.5), ("a", 2.0)]
