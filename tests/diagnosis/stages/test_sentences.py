"""The answer in one sentence, for each verdict; `*` stands for any text."""

import dataclasses
from fnmatch import fnmatchcase

import pytest

from seatsim.diagnosis.answer import write_answer
from seatsim.diagnosis.result import Cause, Diagnosis, Estimate, GapFigures, Gaps, RunGaps, Share

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


FIGURES = "noise 0.052, in standard deviations)"
TAKEN = f": that takes 89% of the gap that can be removed (0.500 to 0.100, {FIGURES}"
HEAVIER = f"driver.mass (an occupant heavier or lighter than the plant states; change 12.3 kg){TAKEN}"
PAIR = ["driver.mass", "sensor.gain"]
END = GAIN._replace(parameters={"error": Estimate(-0.5, 0.1, "-", (-0.5, 1.0), True)}, at_bound=True)
WORSE = dataclasses.replace(GAPS, after=GapFigures(0.6, {}))
RUNS = [
    RunGaps(f"{k}", *(GapFigures(value, {}) for value in (0.5, 0.4, after, 0.0521)), 0.8)
    for k, after in enumerate((0.1, 0.05, 0.15))
]
QUIET = RUNS[0]._replace(before=GapFigures(0.06, {}))
NOISY = dataclasses.replace(GAPS, floor=GapFigures(0.55, {}))


def alike(*groups):
    return {"indistinguishable": [group.split() for group in groups]}


@pytest.mark.parametrize(("verdict", "selected", "changed", "said"), [
    ("none", [], {}, "There is no gap that matters beyond noise and the stated tolerance of the parameters: 0.500"
                     " nominal, 0.400 refitted, noise 0.052 (in standard deviations)."),
    # An unknown cause lies in its block or in one that the channels cannot tell from it.
    ("unknown", [], {}, "Something in the cushion or the suspension or the driver that no effect of the library"
                        " explains makes the gap: 0.500 nominal, noise 0.052 (in standard deviations)."),
    ("unknown", [], {"isolable": [["damper", "sensor"]]}, "Something in the cushion that no effect*"),
    ("unknown", PAIR, alike("driver.mass cushion.hardening"),
     "driver.mass (an occupant heavier or lighter than the plant states; change 12.3 kg); sensor.gain (one channel"
     f" reads with a wrong scale; damper_force, error -0.0512){TAKEN}; these data cannot tell driver.mass from"
     " cushion.hardening. What remains, 0.100, no effect of the library explains; it lies in the cushion or the"
     " suspension or the driver."),
    ("known", ["driver.mass"], {}, f"{HEAVIER}."),
    ("known", PAIR[::-1], {}, "sensor.gain (one channel reads with a wrong scale; damper_force, error -0.0512);"
                              " driver*"),
    ("known", ["sensor.gain"], {"causes": [END]},
     "sensor.gain (one channel reads with a wrong scale; error -0.5, the end of its range; all of its size lies at the"
     " end of its range, so that it may stand for another cause): that takes*"),
    ("ambiguous", ["driver.mass"], alike("driver.mass a b"), f"{HEAVIER}; these data cannot tell it from a and b."),
    ("ambiguous", ["driver.mass"], alike("driver.mass a"), f"{HEAVIER}; these data cannot tell it from a."),
    ("ambiguous", PAIR, alike("driver.mass a", "sensor.gain b"),
     "*; these data cannot tell driver.mass from a; these data cannot tell sensor.gain from b."),
    ("unknown", ["driver.mass"], {"gap": WORSE},
     "*; change 12.3 kg): that takes nothing off the gap of the run held out (0.500 to 0.600, noise 0.052)*"),
    # Shares of 89, 100 and 78 % lie 11 % about the middle one: t of 2.92 times 11 % sqrt(4 / 3), with 1.645 times 3 %.
    ("known", ["driver.mass"], {"gap": dataclasses.replace(GAPS, by_run=RUNS)},
     f"{HEAVIER}; under another excitation 52% to 100% are expected."),
    ("known", ["driver.mass"], {"gap": dataclasses.replace(GAPS, by_run=RUNS[:1])}, f"{HEAVIER}."),
    ("known", ["driver.mass"], {"gap": dataclasses.replace(GAPS, by_run=[RUNS[0], QUIET])}, f"{HEAVIER}."),
    ("known", ["driver.mass"], {"gap": NOISY}, "*takes nothing off*"),
    ("known", [PUSH.effect], {"stochastic": PUSH.effect},
     f"floor.unmeasured_input (a force on the frame that no channel records){TAKEN}; its random signal cannot be"
     " predicted, so that its share of the gap stays."),
])  # fmt: skip
def test_the_answer_is_one_sentence(verdict, selected, changed, said):
    assert fnmatchcase(write_answer(diagnosis(verdict, selected, **changed)), said)
