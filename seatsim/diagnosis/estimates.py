"""What a diagnosis rests on: every effect's own shrink and parameters, and the courses behind the pictures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seatsim.diagnosis.decide import Judgement
from seatsim.diagnosis.fit import SPREAD, Engine, Point, State
from seatsim.diagnosis.localise import discrepancy as rest_of
from seatsim.diagnosis.problem import Problem
from seatsim.diagnosis.result import Cause, Estimate, Evidence, Trace
from seatsim.diagnosis.select import Search
from seatsim.diagnosis.validate import scenario_at
from seatsim.metrics.motion import rms
from seatsim.recordings.gap import measure_gap
from seatsim.scenario.scenario import Scenario
from seatsim.schema.fields import describe

Array = NDArray[np.float64]


def causes(
    engine: Engine,
    found: Search,
    judgement: Judgement,
    calibrated: State,
    augmented: State,
    nominal: Scenario,
    run: str,
) -> list[Cause]:
    """Return every effect, ranked by probability, with its own shrink on a run and its parameters."""
    problem = engine.problem
    base = measure_gap(scenario_at(problem, nominal, calibrated.point), problem.recording, [run]).overall
    singles = {state.point.terms[0].effect: state for state in found.sets[1]} if len(found.sets) > 1 else {}
    own = {term.effect: (term, k) for k, term in enumerate(augmented.point.terms)}
    stated = []
    for effect, probability in judgement.probabilities.items():
        shrink, parameters = 0.0, {}
        state = singles.get(effect)
        if state is not None:
            with_it = scenario_at(problem, nominal, state.point)
            shrink = 1.0 - measure_gap(with_it, problem.recording, [run]).overall / base
            parameters = _parameters(engine, state, 0)
        if effect in own:
            parameters = _parameters(engine, augmented, own[effect][1])
        stated.append(Cause(effect, probability, shrink, parameters))
    return sorted(stated, key=lambda cause: (-cause.probability, -cause.shrink))


def _parameters(engine: Engine, state: State, index: int) -> dict[str, Estimate | str]:
    """Return the free parameters of an effect with their standard deviations from the fit's normal matrix."""
    term, values = state.point.terms[index], state.point.values[index]
    units = {specification.name: specification.unit for specification in describe(term.cls)}
    stds = _deviations(engine, state)
    start = len(state.point.u) + sum(len(t.free) for t in state.point.terms[:index])
    found: dict[str, Estimate | str] = {
        name: Estimate(float(value), float(stds[start + k] * term.scale[k]), units[name])
        for k, (name, value) in enumerate(zip(term.free, values, strict=True))
    }
    return ({"channel": term.fixed["channel"]} if "channel" in term.fixed else {}) | found


def _deviations(engine: Engine, state: State) -> Array:
    """Return standard deviations of `vector`, scaled up by what the fit leaves beyond noise."""
    grams = [engine.gram(run, own, state.whitened[run])[0] for run, own in engine.jacobian(state).items()]
    matrix = np.sum(grams, axis=0)
    index = np.arange(len(state.point.u))
    matrix[index, index] += SPREAD**-2
    rows = sum(values.size for values in state.whitened.values())
    return np.asarray(np.sqrt(np.maximum(np.diag(np.linalg.pinv(matrix)), 0.0) * max(1.0, state.cost / rows)))


def collected(
    problem: Problem, points: Sequence[Point], run: str, rest: rest_of.Latent | None, alike: tuple[list[str], Array]
) -> Evidence:
    """Return the courses on a held-out run, measured and simulated at three points."""
    simulated = [problem.simulated(run, point.u, point.effects) for point in points]
    measured = problem.measured[run]
    time = (problem.skip + np.arange(measured.shape[1])) / problem.recording.header.sample_rate
    traces = [
        Trace(run, name, problem.recording.channels[name].unit, float(problem.noise[k]), time, measured[k],
              *(course[k] for course in simulated))
        for k, name in enumerate(problem.channels)
    ]  # fmt: skip
    drawn = None if rest is None else rest_of.evidence(problem, rest, run)
    return Evidence(traces, _motion(problem, run), drawn, alike, _comfort(traces))


def _motion(problem: Problem, run: str) -> dict[str, Array]:
    samples = problem.measured[run].shape[1]
    table = {k: v[problem.skip : problem.skip + samples] for k, v in problem.recording.table(run).items()}
    position = table.get("suspension_displacement", table.get("displacement"))
    motion: dict[str, Array] = {name: table[name] for name in ("coil_current", "damper_temperature") if name in table}
    if position is None:
        return motion
    rate = problem.recording.header.sample_rate
    smooth = np.convolve(position, np.ones(5) / 5.0, mode="same")
    return motion | {"displacement": position, "velocity": np.gradient(smooth, 1.0 / rate)}


def _comfort(traces: Sequence[Trace]) -> list[tuple[str, str, float, float, float]]:
    quoted = ("driver_acceleration", "frame_acceleration", "suspension_displacement")
    return [
        ("RMS " + name.replace("_", " "), trace.unit, rms(trace.measured), rms(trace.nominal), rms(trace.after))
        for name in quoted for trace in traces if trace.channel == name
    ]  # fmt: skip
