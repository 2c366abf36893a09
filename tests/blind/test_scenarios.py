"""The fault scenarios: complete, the same in every version, material when drawn."""

import json
from pathlib import Path

import numpy as np
import pytest

from seatsim.blind.sealed import EFFECTS
from seatsim.blind.truth.experiment import read_channels, simulate_run
from seatsim.blind.truth.faults import SCENARIOS, Changes, scenarios_of

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
