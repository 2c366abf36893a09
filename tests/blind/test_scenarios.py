"""The fault scenarios: complete, off at zero, material when drawn."""

from __future__ import annotations

import numpy as np
import pytest

from seatsim.blind.labels import BLOCKS, EFFECTS
from seatsim.blind.make.severity import find_severity
from seatsim.blind.truth.experiment import read_channels, simulate_run
from seatsim.blind.truth.faults.catalogue import SCENARIOS, scenarios_of
from seatsim.blind.truth.faults.scenario import Changes

from .experiments import small_experiment


def test_every_effect_has_two_forms_and_every_block_something_outside() -> None:
    assert all(len(scenarios_of(effect)) >= 2 for effect in EFFECTS)
    outside = scenarios_of("outside")
    assert len(outside) >= 14
    assert {scenario.block for scenario in outside} == set(BLOCKS)
    assert all(
        scenario.block == scenario.effect.split(".")[0] for scenario in SCENARIOS.values() if not scenario.outside
    )


@pytest.mark.usefixtures("short")
def test_every_form_is_off_at_zero_and_moves_something_when_on() -> None:
    for bingham in (False, True):
        experiment, context, runs = small_experiment(bingham)
        base = read_channels(experiment, Changes(), 2, simulate_run(experiment, Changes(), 2, runs.commands[2]))
        for scenario in SCENARIOS.values():
            if scenario.bingham != bingham:
                continue
            shape = scenario.draw(np.random.default_rng(1), context)
            off, on = scenario.build(0.0, shape, context), scenario.build(min(4.0, scenario.span[1]), shape, context)
            same = read_channels(experiment, off, 2, simulate_run(experiment, off, 2, runs.commands[2]))
            materiality = read_channels(experiment, on, 2, simulate_run(experiment, on, 2, runs.commands[2]))
            for name, values in base.items():
                np.testing.assert_allclose(same[name], values, atol=1e-9, err_msg=scenario.name)
            assert any(not np.allclose(materiality[name], base[name], atol=1e-6) for name in base), scenario.name


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("name", ["friction-lugre", "skew-fixed", "gain-scale", "remanence-relays"])
def test_a_drawn_severity_is_material(name: str) -> None:
    _, context, runs = small_experiment()
    scenario = SCENARIOS[name]
    rng = np.random.default_rng(2)
    shape = scenario.draw(rng, context)
    found = find_severity(
        lambda s: runs.materiality(scenario.build(s, shape, context), Changes())[0], scenario.span, rng
    )
    assert found is not None
    severity, size = found
    assert 1.0 <= size < 11.0
    assert runs.materiality(scenario.build(severity, shape, context), Changes())[0] == pytest.approx(size)


@pytest.mark.usefixtures("short")
def test_a_shifted_log_counts_by_what_the_replay_misses() -> None:
    _, context, runs = small_experiment()
    scenario = SCENARIOS["skew-fixed"]
    shape = {"channel": 0.0, "sign": 1.0, "detail": 0.5, "seed": 1.0}
    sizes = [runs.materiality(scenario.build(s, shape, context), Changes())[0] for s in (0.0, 0.5, 1.0)]
    assert sizes[0] < 1e-9
    assert 0.0 < sizes[1] < sizes[2]
