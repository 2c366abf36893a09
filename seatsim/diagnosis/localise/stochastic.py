"""Effects whose course is random: found in what no other effect explains, never simulated, counted as noise."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.decide import MATERIAL, Judgement, rests_of
from seatsim.diagnosis.fit import Engine, Point, State
from seatsim.diagnosis.localise.discrepancy import Latent, latent, rms
from seatsim.diagnosis.localise.hypotheses import Suspect
from seatsim.diagnosis.localise.input_estimate import INPUTS, Driven, power
from seatsim.diagnosis.noise import Whitening, smoothed, whitening
from seatsim.diagnosis.problem import Problem
from seatsim.diagnosis.result import Cause, Estimate, Share

Array = NDArray[np.float64]

OUTSIDE, WANDER = "floor.unmeasured_input", "sensor.bias"
OWN = 0.6
"""Share of the gap that it is said to make beside other effects."""
ALONE = 2.0
"""Factor by which the gap that is left of a channel exceeds those of all others where its zero wanders."""


def wandering(problem: Problem, state: State) -> Latent | None:
    """Return the error of the one channel, not the travel, that stays materially open by a slow course, None without.

    A slow force on the rig would move the travel, and creep moves the travel alone.
    """
    rests = rests_of(problem, state)
    k = int(np.argmax(rests))
    name, others = problem.channels[k], np.delete(rests, k)
    if rests[k] < MATERIAL or np.any(others > rests[k] / ALONE) or name == "suspension_displacement":
        return None
    course = {run: values[k] for run, values in state.residual.items()}
    error = Suspect(0.0, f"error of {name}", problem.recording.channels[name].unit, course, name)
    return latent(problem, state.point, "sensor", error)


def random_cause(problem: Problem, rest: Latent) -> str:
    """Return the effect that an unexplained rest may be; an empty word for none."""
    merged = () if "damper_force" in problem.channels else ("damper",)
    if rest.block in ("suspension", *merged) and rest.from_outside:
        return OUTSIDE
    return WANDER if rest.wanders(problem.recording.header.sample_rate) else ""


def counted(engine: Engine, effect: str, rest: Latent) -> Whitening:
    """Return weights in which the course counts as noise."""
    problem = engine.problem
    if effect == OUTSIDE:
        return whitening(problem, rest.course)
    if rest.channel not in problem.channels:
        return whitening(problem, errors={run: _carried(engine, run, course) for run, course in rest.course.items()})
    row = np.array([[name == rest.channel] for name in problem.channels], dtype=float)
    return whitening(problem, errors={run: row * power(np.fft.rfft(course)) for run, course in rest.course.items()})


def _carried(engine: Engine, run: str, course: Array) -> Array:
    """Return the power that a motion of the floor leaves in the channels, shape (channels, frequencies)."""
    problem = engine.problem
    rig = Driven(problem, engine.white, Point(problem.rest), run, INPUTS["floor"], np.zeros(0))
    return smoothed(np.abs(np.fft.rfft(rig.channels(course) - problem.simulated(run, problem.rest, ()))) ** 2)


def joined(judgement: Judgement, where: Sequence[Share], effect: str) -> tuple[Judgement, list[Share]]:
    """Return judgement and places of what was found beside it, with the effect itself among them."""
    probabilities = judgement.probabilities | {effect: 0.9}
    verdict = "ambiguous" if judgement.groups else "known"
    judgement = dataclasses.replace(judgement, verdict=verdict, probabilities=probabilities, none=0.01, unknown=0.1)
    block, own = effect.partition(".")[0], OWN if where else 1.0
    others = [Share(s.block, s.share * (1.0 - own)) for s in where if s.block != block]
    return judgement, [Share(block, 1.0 - sum(share for _, share in others)), *others]


def with_strength(cause: Cause, rest: Latent) -> Cause:
    """Return the cause with the RMS of its course, and the channel that errs."""
    place: dict[str, Estimate | str] = {"channel": rest.channel} if rest.channel else {}
    return cause._replace(parameters=place | {"rms": Estimate(rms(rest), 0.0, rest.unit)})
