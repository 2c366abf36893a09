"""The fault scenarios: complete, the same in every version, material when drawn."""

import json
from pathlib import Path

import numpy as np
import pytest

from seatsim.blind.sealed import EFFECTS
from seatsim.blind.truth.experiment import read_channels, read_sensors, simulate_run
from seatsim.blind.truth.faults import SCENARIOS, Changes, SensorFault, scenarios_of
from seatsim.blind.truth.rig import SAMPLE_RATE, RigMotion

from .experiments import small_experiment


def test_every_effect_has_two_forms_and_every_block_something_outside():
    assert all(len(scenarios_of(effect)) >= 2 for effect in EFFECTS)
    outside = scenarios_of("outside")
    assert len(outside) >= 14
    assert {scenario.block for scenario in outside} == {effect.partition(".")[0] for effect in EFFECTS}


@pytest.mark.parametrize("bingham", [False, True])
def test_every_form_moves_the_channels_as_it_always_did(bingham):
    """A seed means the same set in every version, so what a form does to the channels is pinned, by its name."""
    experiment, context, runs = small_experiment(bingham)
    known = json.loads(Path(__file__).with_name("known_forms.json").read_text(encoding="utf-8"))

    def read(changes):
        return read_channels(experiment, changes, 2, simulate_run(experiment, changes, 2, runs.commands[2]))

    base, found = read(Changes()), {}
    for scenario in SCENARIOS.values():
        if scenario.bingham == bingham:
            shape = scenario.draw(np.random.default_rng(1), context)
            moved = read(scenario.build(min(2.0, scenario.span[1]), shape, context))
            shares = [np.std(moved[name] - values) / np.std(values) for name, values in base.items()]
            found[scenario.name] = sum(map(float, shares))
    assert found and min(found.values()) > 1e-4
    assert found == pytest.approx({name: known[name] for name in found}, rel=1e-5)


def test_a_shifted_log_counts_by_what_the_replay_misses():
    _, context, runs = small_experiment()
    scenario = SCENARIOS["skew-fixed"]
    shape = {"channel": 0.0, "sign": 1.0, "detail": 0.5, "seed": 1.0}
    sizes = [runs.materiality(scenario.build(s, shape, context), Changes())[0] for s in (0.0, 0.5, 1.0)]
    assert sizes[0] < 1e-9
    assert 0.0 < sizes[1] < sizes[2]


def motion(rows=500):
    flat, fine = np.zeros(rows), np.arange(rows * 20) / (20.0 * SAMPLE_RATE)
    return RigMotion(flat, flat + 1.0, flat, flat + 2.0, np.arange(rows) * 1.0, fine[::20], flat + 3.0, fine)


def test_a_late_log_is_late_by_its_size():
    late = SensorFault("skew", "log", 0.01)
    read = read_sensors(motion(), np.arange(2000.0), [late], 0)
    np.testing.assert_allclose(read["coil_current"][50:], motion().current[50:] - 0.01)
    np.testing.assert_allclose(read["current_command"][50:], motion().command[50:] - 5.0)
    np.testing.assert_array_equal(read["floor_acceleration"], np.arange(0.0, 2000.0, 4.0))
    drifting = late._replace(detail=0.5)
    assert late.on_input and not SensorFault("gain", "damper_force", 0.1).on_input
    for run, left in ((0, 1.0 - 0.5 * 0.6), (1, 0.5)):
        read = read_sensors(motion(), np.arange(2000.0), [drifting], run)
        assert motion().current[-1] - read["coil_current"][-1] == pytest.approx(0.01 * left)
