"""The truth forms: complete, off at zero, material when drawn."""

from __future__ import annotations

import numpy as np
import pytest

from seatsim.blind.make.case import drive, read
from seatsim.blind.make.sizing import severity_for
from seatsim.blind.truth.catalogue import TRUTHS, forms_of
from seatsim.blind.truth.truth import BLOCKS, EFFECTS, Changes

from .settings import small_setting


def test_every_effect_has_two_forms_and_every_block_something_outside() -> None:
    assert all(len(forms_of(effect)) >= 2 for effect in EFFECTS)
    outside = forms_of("outside")
    assert len(outside) >= 14
    assert {truth.block for truth in outside} == set(BLOCKS)
    assert all(truth.block == truth.effect.split(".")[0] for truth in TRUTHS.values() if not truth.outside)


@pytest.mark.usefixtures("short")
def test_every_form_is_off_at_zero_and_moves_something_when_on() -> None:
    for bingham in (False, True):
        setting, context, bench = small_setting(bingham)
        base = read(setting, Changes(), 2, drive(setting, Changes(), 2, bench.commands[2]))
        for truth in TRUTHS.values():
            if truth.bingham != bingham:
                continue
            shape = truth.draw(np.random.default_rng(1), context)
            off, on = truth.build(0.0, shape, context), truth.build(min(4.0, truth.span[1]), shape, context)
            same = read(setting, off, 2, drive(setting, off, 2, bench.commands[2]))
            moved = read(setting, on, 2, drive(setting, on, 2, bench.commands[2]))
            for name, values in base.items():
                if name != "damper_temperature":  # the heat capacity is part of the fade's shape
                    np.testing.assert_allclose(same[name], values, atol=1e-9, err_msg=truth.name)
            assert any(not np.allclose(moved[name], base[name], atol=1e-6) for name in base), truth.name


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("name", ["friction-lugre", "skew-fixed", "gain-scale", "remanence-relays"])
def test_a_drawn_severity_is_material(name: str) -> None:
    _, context, bench = small_setting()
    truth = TRUTHS[name]
    rng = np.random.default_rng(2)
    shape = truth.draw(rng, context)
    found = severity_for(lambda s: bench.moved(truth.build(s, shape, context), Changes())[0], truth.span, rng)
    assert found is not None
    severity, size = found
    assert 1.0 <= size < 11.0
    assert bench.moved(truth.build(severity, shape, context), Changes())[0] == pytest.approx(size)


@pytest.mark.usefixtures("short")
def test_a_shifted_log_counts_by_what_the_replay_misses() -> None:
    _, context, bench = small_setting()
    truth = TRUTHS["skew-fixed"]
    shape = {"channel": 0.0, "sign": 1.0, "detail": 0.5, "seed": 1.0}
    sizes = [bench.moved(truth.build(s, shape, context), Changes())[0] for s in (0.0, 0.5, 1.0)]
    assert sizes[0] < 1e-9
    assert 0.0 < sizes[1] < sizes[2]
