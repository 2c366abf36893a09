"""The answer in one sentence, for each verdict."""

import dataclasses

import pytest

from seatsim.diagnosis.answer import write_answer
from seatsim.diagnosis.result import Cause, Diagnosis, Estimate, GapFigures, Gaps, Share

GAPS = Gaps(*(GapFigures(value, {}) for value in (0.5, 0.4, 0.1, 0.0521)), 0.8, (0.7, 0.9))
MASS = Cause("driver.mass", 0.9, 0.7, {"change": Estimate(12.3456, 0.5, "kg")})
GAIN = Cause("sensor.gain", 0.8, 0.5, {"channel": "damper_force", "error": Estimate(-0.0512, 0.1, "-")})
PUSH = Cause("floor.unmeasured_input", 0.9, 0.0, {})


def diagnosis(verdict, selected=(), **changed):
    found = Diagnosis(
        name="x", verdict=verdict, sentence="", where=[Share("cushion", 0.7), Share("damper", 0.3)],
        causes=[GAIN, PUSH, MASS], probability_none=0.0, probability_unknown=0.0, selected=list(selected),
        stochastic="", indistinguishable=[], experiment=None, held_out=["a"],
        isolable=[["damper", "sensor"], ["suspension", "cushion", "driver"]], gap=GAPS, notes=[], augmented={},
        evidence=None,
    )  # fmt: skip
    return dataclasses.replace(found, **changed)


def test_no_gap():
    assert write_answer(diagnosis("none")) == (
        "There is no gap beyond noise and the stated tolerance of the parameters: 0.500 nominal, 0.400 refitted,"
        " noise 0.052 (in standard deviations)."
    )


def test_something_unknown_alone_in_a_block_or_those_that_channels_cannot_tell_from_it():
    assert write_answer(diagnosis("unknown")) == (
        "Something in the cushion or the suspension or the driver that no effect of the library explains makes the gap:"
        " 0.500 nominal, noise 0.052 (in standard deviations)."
    )
    alone = diagnosis("unknown", isolable=[["damper", "sensor"]])
    assert write_answer(alone).startswith("Something in the cushion that no effect")


def test_something_unknown_beside_effects():
    found = diagnosis(
        "unknown", ["driver.mass", "sensor.gain"], indistinguishable=[["driver.mass", "cushion.hardening"]]
    )
    assert write_answer(found) == (
        "driver.mass (an occupant heavier or lighter than the plant states; change 12.3 kg); sensor.gain (one channel"
        " reads with a wrong scale; damper_force, error -0.0512): that takes 89% of the gap that can be removed (0.500"
        " to 0.100, noise 0.052, in standard deviations); these data cannot tell driver.mass from cushion.hardening."
        " What remains, 0.100, no effect of the library explains; it lies in the cushion or the suspension or the"
        " driver."
    )


def test_a_known_cause_with_its_parameters_and_what_it_takes_off():
    assert write_answer(diagnosis("known", ["driver.mass"])) == (
        "driver.mass (an occupant heavier or lighter than the plant states; change 12.3 kg): that takes 89% of the gap"
        " that can be removed (0.500 to 0.100, noise 0.052, in standard deviations)."
    )


def test_several_causes_with_a_channel_and_a_number_without_unit():
    sentence = write_answer(diagnosis("known", ["sensor.gain", "driver.mass"]))
    assert sentence.startswith(
        "sensor.gain (one channel reads with a wrong scale; damper_force, error -0.0512); driver"
    )


def test_a_size_at_the_end_of_its_range_is_said():
    end = GAIN._replace(parameters={"error": Estimate(-0.5, 0.1, "-", (-0.5, 1.0), True)}, at_bound=True)
    assert write_answer(diagnosis("known", ["sensor.gain"], causes=[end])).startswith(
        "sensor.gain (one channel reads with a wrong scale; error -0.5, the end of its range; all of its size lies at"
        " the end of its range, so that it may stand for another cause): that takes"
    )


@pytest.mark.parametrize(
    ("groups", "said"),
    [
        ([["driver.mass", "a", "b"]], "; these data cannot tell it from a and b."),
        ([["driver.mass", "a"]], "; these data cannot tell it from a."),
    ],
)
def test_ambiguous_effects_are_said_last(groups, said):
    sentence = write_answer(diagnosis("ambiguous", ["driver.mass"], indistinguishable=groups))
    assert sentence.endswith("noise 0.052, in standard deviations)" + said)


def test_of_several_effects_each_group_is_named():
    groups = [["driver.mass", "a"], ["sensor.gain", "b"]]
    sentence = write_answer(diagnosis("ambiguous", ["driver.mass", "sensor.gain"], indistinguishable=groups))
    assert sentence.endswith("; these data cannot tell driver.mass from a; these data cannot tell sensor.gain from b.")


def test_what_takes_nothing_off_the_gap_is_said_so():
    worse = dataclasses.replace(GAPS, after=GapFigures(0.6, {}))
    assert "; change 12.3 kg): that takes nothing off the gap of the run held out (0.500 to 0.600, noise 0.052)" in (
        write_answer(diagnosis("unknown", ["driver.mass"], gap=worse))
    )
    noisy = dataclasses.replace(GAPS, floor=GapFigures(0.55, {}))
    assert "takes nothing off" in write_answer(diagnosis("known", ["driver.mass"], gap=noisy))


def test_a_random_signal_keeps_its_share_of_the_gap():
    sentence = write_answer(diagnosis("known", [PUSH.effect], stochastic=PUSH.effect))
    assert sentence.endswith("deviations); its random signal cannot be predicted, so that its share of the gap stays.")
    assert sentence.startswith("floor.unmeasured_input (a force on the frame that no channel records): that takes 89%")
    assert not any(word in write_answer(diagnosis("known", ["driver.mass"])) for word in ("random", "foretold"))
