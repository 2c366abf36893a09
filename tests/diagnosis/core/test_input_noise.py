"""Noise of a bench's inputs, carried through a damper to its force, against noise drawn anew from the true motion."""

import dataclasses

import numpy as np
import pandas as pd
import pytest

from seatsim.diagnosis.noise import _draw_floor, carry_input_noise, weigh_noise
from seatsim.diagnosis.problem import pose_problem
from seatsim.recordings.recording import load_recording
from seatsim.simulation.inputs import BenchInputs
from seatsim.simulation.respond import respond

from ..builders import SerialExecutor
from .toy import add_up, draw_signals, make_problem

RATE, ROWS, NOISE = 200.0, 1500, 2e-5
TIME = np.arange(ROWS) / RATE
MOTION = 0.01 * np.sin(2 * np.pi * 1.5 * TIME)
VELOCITY = 0.01 * 2 * np.pi * 1.5 * np.cos(2 * np.pi * 1.5 * TIME)
FLOWING = 0.5 + 0.2 * np.sin(7.0 * TIME)
UNITS = {"displacement": "m", "velocity": "m/s", "coil_current": "A", "damper_force": "N"}
NOMINAL = """\
damper: {model: bingham, parameters: {c_a: 2000.0, c_b: 0.0, fc_a: 0.0, fc_b: 500.0, f0: 0.0, v_ref: 0.02}}
actuator: {rate: 130.0, max_current: 1.0}
temperature: 20.0
"""


def pose(folder, *further, current_noise=0.0):
    """Return a bench of 1500 rows at 200 Hz whose motion reads with 20 micrometres of noise."""
    rng = np.random.default_rng(5)
    stated = {"displacement": NOISE, "velocity": 2e-3, "coil_current": current_noise, "damper_force": 1.0}
    true = {"displacement": MOTION, "velocity": VELOCITY, "coil_current": FLOWING, "damper_force": 2000.0 * VELOCITY}
    names = ("displacement", *further, "damper_force")
    table = {name: true[name] + stated[name] * rng.standard_normal(ROWS) for name in names}
    pd.DataFrame(table).to_csv(folder / "a.csv", index=False)
    channels = ", ".join(f"{name}: {{unit: {UNITS[name]}, noise_rms: {stated[name]}}}" for name in names)
    (folder / "recording.yaml").write_text(
        f"rig: damper_bench\nsample_rate: {RATE}\nparameter_tolerance: 0.02\nnominal: nominal.yaml\n"
        f"runs: [{{name: a, file: a.csv}}]\nchannels: {{{channels}}}\n"
    )
    (folder / "nominal.yaml").write_text(NOMINAL)
    return pose_problem(load_recording(folder), SerialExecutor())


def spread_of_force(problem, **noise):
    """Return the RMS in N of the difference that noise makes about the true motion, over 12 draws, beside the mean."""
    rng = np.random.default_rng(6)
    skip = slice(problem.skip, problem.skip + problem.measured["a"].shape[1])
    true = BenchInputs(1.0 / RATE, MOTION, NOISE, coil_current=FLOWING if "coil_current" in noise else None)
    if "velocity" in noise:
        true = true._replace(velocity=VELOCITY)
    drawn = []
    for _ in range(12):
        read = {name: getattr(true, name) + size * rng.standard_normal(ROWS) for name, size in noise.items()}
        drawn.append(respond(problem.scenario, true._replace(**read))["damper_force"][skip])
    return np.sqrt(np.mean((np.array(drawn) - np.mean(drawn, axis=0)) ** 2) * 12 / 11)


def carried(problem):
    """Return the RMS in N that the carried noise states for the force."""
    samples = problem.measured["a"].shape[1]
    force = problem.channels.index("damper_force")
    power = carry_input_noise(problem, "a")[force]
    return np.sqrt((2.0 * power.sum() - power[0]) / samples**2)


def test_noise_of_the_motion_is_that_of_the_smoothed_path(tmp_path):
    problem = pose(tmp_path)
    found, expected = carried(problem), spread_of_force(problem, displacement=NOISE)
    assert found == pytest.approx(expected, rel=0.25)
    # Differences of the raw rows would be noisier by far.
    assert found < 0.2 * 2000.0 * NOISE * RATE / np.sqrt(2.0)


def test_noise_of_a_recorded_velocity_is_carried(tmp_path):
    problem = pose(tmp_path, "velocity")
    assert carried(problem) == pytest.approx(spread_of_force(problem, velocity=2e-3), rel=0.1)


def test_the_weights_of_a_bench_count_it(tmp_path):
    problem = pose(tmp_path)
    settings = problem.settings._replace(noise=problem.settings.noise._replace(model_error=0.0))
    weights = weigh_noise(dataclasses.replace(problem, settings=settings)).weights["a"]
    samples = problem.measured["a"].shape[1]
    power = 2.0 / weights**2
    assert np.all(power >= samples * 1.0**2 * (1.0 - 1e-9))
    assert np.max(power) > 1.5 * samples * 1.0**2


def test_noise_of_the_floor_is_drawn_at_the_rows_and_runs_straight_between():
    signals = draw_signals(["nominal"], {"a": 2000})
    problem = make_problem(signals, add_up(signals, {}), floor_noise=0.3)
    drawn = _draw_floor(problem, problem.inputs["a"], np.random.default_rng(1)).floor.acceleration
    drawn = drawn - problem.inputs["a"].floor.acceleration
    rows = drawn[:: problem.parts]
    assert np.std(rows) == pytest.approx(0.3, rel=0.1) and abs(np.mean(rows)) < 0.03
    assert np.ptp(np.abs(rows)) > 0.6
    np.testing.assert_allclose(drawn[1:-1:2], 0.5 * (drawn[:-2:2] + drawn[2::2]))
