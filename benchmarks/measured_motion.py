"""A rig whose blocks are all fed measured signals, in place of one that the recorded floor and command drive alone."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from seatsim.diagnosis.nuisance import vary
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.problem import DiagnosisProblem
from seatsim.diagnosis.spectra import smooth_spectrum
from seatsim.effects.base import EFFECTS
from seatsim.excitations.base import Floor
from seatsim.rig.plant import Plant
from seatsim.schema.errors import RunError
from seatsim.schema.registry import Record
from seatsim.simulation.augment import read_sensors, undo_reading
from seatsim.simulation.inputs import Forces, SeatInputs

Array = NDArray[np.float64]

HEAVY = 1e10
"""kg; mass of a frame that no force of the rig moves by more than 1e-6 m in a run."""
CORNER = 40.0
"""Hz below which the measured displacement, of which derivatives are taken, is fed."""
SETTLING = 0.5
"""s; what is fed has to settle: for so long the answer is what was measured, and over as long again it goes over."""
FRAME, TRAVEL = "frame_acceleration", "suspension_displacement"
FORCE, CURRENT = "damper_force", "coil_current"


class HeavyFrame(NamedTuple):
    """Stands among the effects: a frame so heavy that it moves as it is pushed."""

    mass: float = HEAVY

    def plant(self, plant: Plant) -> Plant:
        """Return the seat with the heavy frame."""
        return plant._replace(frame_mass=self.mass)


class MeasuredMotionProblem(DiagnosisProblem):
    """A problem whose residuals are those of a rig that is fed measured signals."""

    def residuals(self, rigs: Sequence[tuple[Array, Sequence[Record]]]) -> list[dict[str, Array]]:
        """Return `measured - simulated` of every run for each rig (deviations, effects), on all cores."""
        jobs = [(index, run) for index in range(len(rigs)) for run in self.runs]
        answers = self.pool.map(lambda job: self._attempted_residual(job[1], *rigs[job[0]]), jobs)
        found: list[dict[str, Array]] = [{} for _ in rigs]
        for (index, run), values in zip(jobs, answers, strict=True):
            found[index][run] = values
        return found

    def _attempted_residual(self, run: str, deviations: Array, effects: Sequence[Record]) -> Array:
        """Return the residual of a run, infinite where the rig leaves all bounds."""
        try:
            return self.measured[run] - simulate_fed(self, run, deviations, effects)
        except RunError:
            return np.full(self.measured[run].shape, np.inf)


def has_measured_motion(problem: DiagnosisProblem) -> bool:
    """Whether the motion of frame and suspension was measured, so that it can be fed."""
    return {FRAME, TRAVEL} <= set(problem.channels)


def feed_problem(problem: DiagnosisProblem) -> MeasuredMotionProblem:
    """Return the problem with all blocks fed measured signals."""
    return MeasuredMotionProblem(
        problem.recording, problem.scenario, problem.runs, problem.channels, problem.measured, problem.inputs,
        problem.parameters, problem.settings, problem.pool,
    )  # fmt: skip


def feed_objective(objective: Objective) -> Objective:
    """Return the objective over a fed rig; its weights hold, beside what they held, what the noise of the feed leaves.

    That is found on a replicate of the nominal rig, fed its own noisy signals.
    """
    problem, replicate = objective.problem, replicate_nominal(objective.problem)
    left_by_feed = {}
    for run in problem.runs:
        left = replicate.measured[run] - simulate_fed(replicate, run, problem.nominal, ())
        power = smooth_spectrum(np.abs(np.fft.rfft(left, axis=1)) ** 2, problem.settings.noise.smoothing)
        left_by_feed[run] = power
    return Objective(feed_problem(problem), objective.weights.add(left_by_feed))


def simulate_fed(problem: DiagnosisProblem, run: str, deviations: Array, effects: Sequence[Record]) -> Array:
    """Return the compared channels, shape (channels, samples), of a rig whose blocks are all fed measured signals.

    A heavy frame is pushed to move with the measured acceleration a, on a floor that moves with a - x'', so that the
    suspension moves by the measured displacement x. Damper and cushion then answer to measured motion, the damper to
    the measured current, the coil to the command, and the frame's equation, with the sum S of the forces on it and its
    mass ms, says what it should do:

        frame_acceleration = S / ms,

    where the damper's force in S is the measured one if there is a load cell. What a wrong sensor reads is undone
    before it is fed. The recorded floor enters no equation. Over a first second, while what is fed settles, the answer
    goes over from the measured channels.
    """
    step, inputs = 1.0 / problem.rate, problem.inputs[run]
    assert isinstance(inputs, SeatInputs)
    sensors = [effect for effect in effects if EFFECTS.specification_of(type(effect)).by_channel]
    others = [effect for effect in effects if not EFFECTS.specification_of(type(effect)).by_channel]
    true = {
        name: undo_reading(sensors, problem.measured[run][k], name, step) for k, name in enumerate(problem.channels)
    }
    motion = _extend_to_floor(problem, true[FRAME], inputs.floor)
    found = _simulate_clamped(problem, run, deviations, others, true)
    forces = HEAVY * (found[FRAME] - motion[problem.skip * problem.parts :: problem.parts][: len(found[FRAME])])
    if FORCE in found:
        forces = forces + found[FORCE] - true[FORCE]
    plant = vary_plant(problem, deviations)
    said = np.array(list(read_sensors(sensors, step, found | {FRAME: forces / plant.frame_mass}).values()))
    settled = np.clip(np.arange(said.shape[1]) * step / SETTLING - 1.0, 0.0, 1.0)
    return np.asarray(problem.measured[run] + settled * (said - problem.measured[run]))


def vary_plant(problem: DiagnosisProblem, deviations: Array) -> Plant:
    """Return the seat's parameters at some deviations from the nominal ones."""
    plant = vary(problem.scenario, problem.parameters, deviations).plant
    assert plant is not None
    return plant


def replicate_nominal(problem: DiagnosisProblem) -> DiagnosisProblem:
    """Return the problem with what the nominal rig would have recorded, with the stated noise of all channels."""
    rng = np.random.default_rng(0)
    level = problem.recording.channels["floor_acceleration"].noise_rms
    measured = {}
    for run in problem.runs:
        inputs = problem.inputs[run]
        assert isinstance(inputs, SeatInputs)
        floor = inputs.floor
        shaken = floor._replace(acceleration=floor.acceleration + level * rng.standard_normal(len(floor.time)))
        true = problem.simulated(run, problem.nominal, (), inputs._replace(floor=shaken))
        measured[run] = true + problem.noise[:, None] * rng.standard_normal(true.shape)
    return dataclasses.replace(problem, measured=measured)


def _simulate_clamped(
    problem: DiagnosisProblem, run: str, deviations: Array, effects: Sequence[Record], true: Mapping[str, Array]
) -> dict[str, Array]:
    """Return the channels of a rig whose heavy frame and suspension move as measured.

    The coil answers to the command, all else to the measured current, where both are known.
    """
    inputs = problem.inputs[run]
    assert isinstance(inputs, SeatInputs)
    floor = inputs.floor
    motion, position = (_extend_to_floor(problem, true[name], floor) for name in (FRAME, TRAVEL))
    position = sosfiltfilt(butter(4, CORNER, fs=1.0 / floor.step, output="sos"), position)
    base = floor._replace(acceleration=motion - np.gradient(np.gradient(position, floor.step), floor.step))

    def simulate_on(base: Floor) -> dict[str, Array]:
        clamped = inputs._replace(floor=base, forces=Forces(HEAVY * motion))
        outputs = problem.simulated(run, deviations, [*effects, HeavyFrame()], clamped)
        return dict(zip(problem.channels, outputs, strict=True))

    found = simulate_on(base)
    if CURRENT in true and floor.command is not None:
        measured = base._replace(command=None, coil_current=_extend_to_floor(problem, true[CURRENT], floor))
        found = simulate_on(measured) | {CURRENT: found[CURRENT]}
    return found


def _extend_to_floor(problem: DiagnosisProblem, values: Array, floor: Floor) -> Array:
    """Return a signal of the rows compared at the steps of a floor, turned about its ends beyond them.

    It is faded in from rest over the second that is not compared.
    """
    rate, skip = problem.rate, problem.skip
    rows = round(floor.time[-1] * rate) + 1
    whole = np.pad(values, (skip, rows - skip - len(values)), "reflect", reflect_type="odd")
    whole[:skip] *= np.sin(0.5 * np.pi * np.linspace(-0.1, 1.0, skip).clip(0.0)) ** 2
    return np.interp(floor.time * rate, np.arange(rows), whole)
