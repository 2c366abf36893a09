"""The proposed experiment of a linear seat: what is proposed, by which figures, in which words."""

import copy
import dataclasses
import re

import numpy as np
import pytest

from seatsim.diagnosis.candidates import Candidate
from seatsim.diagnosis.design import experiment
from seatsim.diagnosis.design.candidate_experiments import CandidateExperiment, list_candidate_experiments
from seatsim.diagnosis.design.experiment import propose_experiment
from seatsim.effects.seat import Mass
from seatsim.effects.sensor import ClockSkew, Gain
from seatsim.excitations.base import Floor
from seatsim.simulation.inputs import BenchInputs, SeatInputs

from .toy import CHANNELS, NUISANCES, RATE, SIZES, SKIP, TAPS, Added, add_taps, offer, place, pose, record, weigh_stated

PRIOR, WIDE = 0.58, 10.0
NOISE = 0.05
GROUP, GROUP_FAST = ["x.slow", "damper.gas_spring"], ["x.fast", "damper.gas_spring"]


def slow_floor(rows, seed=3):
    """Return a floor that hardly moves from one row to the next, so that `slow` and `fast` are the same."""
    return np.cumsum(np.random.default_rng(seed).standard_normal(rows)) / 10.0


def make_objective(folder, truth):
    runs = {"first": slow_floor(SKIP + 200), "second": slow_floor(SKIP + 240, 4)}
    return weigh_stated(pose(record(folder, truth, runs, noise=NOISE), nuisances=1))


def linearise(objective, *terms):
    rig = objective.evaluate([place(objective.problem, *terms)])[0]
    return objective.linearise_nuisances(rig)


@pytest.fixture(scope="module")
def equivalent(folder):
    """A rig with an effect that another imitates wherever the floor is slow."""
    objective = make_objective(folder, (Added("fast", 2.0),))
    return objective, linearise(objective, (offer("x.fast", "fast"), 2.0))


def test_the_cheapest_experiment_that_parts_the_members_is_proposed(equivalent):
    found = propose_experiment(*equivalent, GROUP_FAST)
    # A bump is slow as well; from 1 to 20 Hz the floor changes from row to row.
    assert (found.kind, found.name) == ("excitation", "sweep")
    assert found.likeness_now > 0.99 and found.likeness_then < found.likeness_now
    assert re.match(r"sweep the floor from [\d.]+ to [\d.]+ Hz at [\d.]+ m/s\^2: they then differ by ", found.reason)
    assert found.reason.endswith(f", likeness {found.likeness_then:.2f} instead of {found.likeness_now:.2f}")
    assert found.scenario["name"] == "experiment-sweep"


def ridge(change, columns, deviations):
    rows = np.vstack([columns.T, np.diag(1.0 / np.array(deviations))])
    target = np.concatenate([change, np.zeros(len(deviations))])
    return target - rows @ np.linalg.lstsq(rows, target, rcond=None)[0]


def stack_taps(problem, cause, weights, floor):
    """Return the weighted signal of a cause under a floor at the rows, without the first second, on end."""
    return (weights * add_taps(cause, floor)[:2, SKIP:]).ravel()


def assess(objective, nuisances, base, members, name):
    (candidate,) = [c for c in list_candidate_experiments(objective.problem) if c.name == name]
    return experiment._assess(objective, nuisances, base, members, candidate), candidate


@pytest.fixture(scope="module")
def assessed(folder):
    """Two rigs with an effect each, and the rig without, all unfitted."""
    objective = make_objective(folder, (Added("one", 0.5),))
    problem, terms = objective.problem, [(offer("a", "one"), 0.5), (offer("b", "two"), 0.4)]
    first, second, base = objective.evaluate([place(problem, terms[0]), place(problem, terms[1]), place(problem)])
    return objective, objective.linearise_nuisances(first), base, [first, second]


@pytest.mark.parametrize("name", ["sweep", "added_mass"])
def test_separability_and_likeness_are_those_of_the_signals_under_the_floor_of_the_experiment(assessed, name):
    objective, nuisances, base, members = assessed
    found, candidate = assess(objective, nuisances, base, members, name)
    step = round(1.0 / RATE / candidate.floor.step)
    floor = candidate.floor.acceleration[::step]
    added = (candidate.set.get("plant.driver_mass", 80.0) - 80.0) / 80.0
    rig = add_taps("floor", floor) + 0.5 * add_taps("one", floor) + added * add_taps("mass", floor)
    if candidate.floor.command is not None:
        rig = rig + add_taps("current", candidate.floor.command[::step])
    noise = NOISE * SIZES[:2]
    weights = 1.0 / np.hypot(noise, 0.01 * np.std(rig[:2, SKIP:], axis=1))[:, None]
    signals = {cause: stack_taps(objective.problem, cause, weights, floor) for cause in ("one", "two", "mass")}
    own = {"one": signals["one"], "two": signals["two"]}
    # The tolerance is relative, so that a mass that was set is known as well as the nominal one.
    shared = 0.1 * (1.0 + added) * signals["mass"][None]
    changes = [0.5 * signals["one"], 0.4 * signals["two"]]
    left = [ridge(change, shared, [PRIOR]) for change in changes]
    likeness = (2.0 * abs(left[0] @ left[1]) + 1.0) / (left[0] @ left[0] + left[1] @ left[1] + 1.0)
    assert found.likeness == pytest.approx(likeness, rel=1e-6)
    whitened = {cause: whiten_all(objective, cause) for cause in ("one", "two", "mass")}
    known = 0.1 * whitened["mass"][None]
    gains = []
    for cause in own:
        gap_old = 0.4 * whitened["two"] - 0.5 * whitened["one"]
        gap_new = changes[1] - changes[0]
        both = np.hstack([np.vstack([known, whitened[cause]]), np.vstack([shared, own[cause]])])
        after = ridge(np.concatenate([gap_old, gap_new]), both, [PRIOR, WIDE])
        before = ridge(gap_old, np.vstack([known, whitened[cause]]), [PRIOR, WIDE])
        gains.append(after @ after - before @ before)
    assert found.separability == pytest.approx(np.sqrt(min(gains)), rel=1e-5)


def whiten_all(objective, cause):
    problem = objective.problem
    parts = []
    for run in problem.runs:
        floor = problem.recording.table(run)["floor_acceleration"]
        rows = slice(SKIP, SKIP + problem.measured[run].shape[1])
        parts.append(objective.weights(add_taps(cause, floor)[:2, rows], run).ravel())
    return np.concatenate(parts)


def test_what_no_experiment_parts_is_said_so(folder):
    objective = make_objective(folder, (Added("slow", 0.8),))
    nuisances = linearise(objective, (offer("x.slow", "slow"), 0.8))
    found = propose_experiment(objective, nuisances, GROUP)
    assert (found.kind, found.name, found.scenario) == ("none", "none on the menu", None)
    assert found.reason.startswith("no candidate experiment separates them: the best, ")
    assert found.reason.endswith(" does so by 0.0 times the noise only")
    assert found.likeness_now > 0.999 and found.likeness_then > 0.999


def test_candidates_are_tried_as_far_as_the_first_that_parts_all_members(assessed):
    objective, nuisances, base, members = assessed
    settings = objective.settings

    def tried(**changed):
        problem = dataclasses.replace(
            objective.problem, settings=settings._replace(design=settings.design._replace(**changed))
        )
        other = dataclasses.replace(objective, problem=problem)
        return [each.candidate.name for each in experiment._assess_candidates(other, nuisances, base, members)]

    every = [each.name for each in list_candidate_experiments(objective.problem)]
    assert tried(separated=1e9, trials=0) == every and tried(unlike=0.0, trials=0) == every
    assert tried(separated=1e-9, unlike=1.1, trials=0, largest_travel=1e9) == every[:1]
    optimised = tried(separated=1e9, trials=5)
    (name,) = set(optimised[5:10])
    assert name in every[:5] and optimised == [*every[:5], *[name] * 5, *every[5:]]


def test_an_optimised_excitation_parts_the_members_better_within_travel_and_current(equivalent):
    objective, nuisances = equivalent
    usual = objective.settings

    def propose(**changed):
        settings = usual._replace(design=usual.design._replace(**changed))
        problem = dataclasses.replace(objective.problem, settings=settings)
        return propose_experiment(dataclasses.replace(objective, problem=problem), nuisances, GROUP_FAST)

    plain, found = propose(trials=0), propose(trials=16)
    assert plain.kind == found.kind == "excitation" and found.likeness_then <= plain.likeness_then
    top = objective.problem.scenario.coil.max_current
    assert 0.0 < found.scenario["controller"]["current"] <= top
    # No floor that moves the suspension is within no travel: a change of the rig is proposed, or nothing.
    assert propose(largest_travel=1e-12).kind != "excitation"


def test_the_reach_of_an_excitation_is_its_share_of_the_travel(assessed):
    objective, nuisances, base, members = assessed
    problem, (found, candidate) = objective.problem, assess(objective, nuisances, base, members, "sweep")
    rig = nuisances.evaluation.parameters
    travel = experiment._respond(problem, candidate, rig)["suspension_displacement"]
    assert found.reach == pytest.approx(np.max(np.abs(travel)) / 0.05)
    plant = problem.scenario.plant._replace(travel=(-1e3, 0.02))
    stated = dataclasses.replace(problem, scenario=dataclasses.replace(problem.scenario, plant=plant))
    assert experiment._measure_reach(stated, candidate, rig) == pytest.approx(np.max(travel) / 0.02)
    assert assess(objective, nuisances, base, members, "added_mass")[0].reach == 0.0


def test_a_change_of_the_rig_says_what_its_run_states(equivalent):
    still = Floor(0.005, *[np.zeros(3)] * 3)
    heavier = CandidateExperiment("added_mass", "add mass", still, set={"plant.driver_mass": 100.0})
    found = experiment._choose(equivalent[0], [experiment._Verdict(90.0, 0.5, heavier)], "", 1.0)
    assert found.reason.endswith("; its run in recording.yaml states set: {plant.driver_mass: 100}")
    assert found.as_dict()["set"] == {"plant.driver_mass": 100.0} and "file" not in found.as_dict()
    assert "set" not in experiment._propose("none", "x", "y", 1.0, 1.0).as_dict()


def verdict(separability, likeness, name, scenario=None, text="do it"):
    still = Floor(0.005, *[np.zeros(3)] * 3)
    return experiment._Verdict(separability, likeness, CandidateExperiment(name, text, still, scenario=scenario))


def test_of_those_that_separate_the_one_under_which_members_are_least_alike_is_chosen(equivalent):
    objective = equivalent[0]
    seen = [verdict(31.0, 0.95, "a"), verdict(90.0, 0.92, "b"), verdict(1000.0, 0.97, "c"), verdict(29.0, 0.1, "d")]
    found = experiment._choose(objective, seen, "first; ", 0.98764)
    assert (found.kind, found.name) == ("intervention", "b")
    assert found.reason == "first; do it: they then differ by 90 times the noise, likeness 0.92 instead of 0.99"
    assert (found.likeness_now, found.likeness_then) == (0.9876, 0.92)


def test_where_none_separates_the_best_is_named_but_not_proposed(equivalent):
    seen = [verdict(3.0, 0.2, "a"), verdict(30.0, 0.6, "b", {"excitation": {}}), verdict(5.0, 0.9, "c")]
    found = experiment._choose(equivalent[0], seen, "", 1.0)
    assert (found.kind, found.name, found.scenario) == ("none", "none on the menu", None)
    assert found.reason == "no candidate experiment separates them: the best, b, does so by 30.0 times the noise only"
    assert found.likeness_then == 0.6
    assert experiment._choose(equivalent[0], seen[1:2], "", 1.0).kind == "none"


def test_an_excitation_has_a_scenario_without_what_is_not_repeated(equivalent):
    problem = equivalent[0].problem
    source = copy.copy(problem.scenario.source)
    stated = {"start": {"displacement": 0.1}, "sweep": {}, "name": "nominal", "effects": [{"effect": "driver.mass"}]}
    source.data = source.data | stated
    scenario = dataclasses.replace(problem.scenario, source=source, effects=(Mass(10.0),))
    problem = dataclasses.replace(problem, scenario=scenario)
    candidate = verdict(90.0, 0.1, "b", {"controller": {"law": "constant"}, "excitation": {"kind": "sine"}}).candidate
    found = experiment._write_scenario(problem, candidate)
    assert found["name"] == "experiment-b" and found["excitation"] == {"kind": "sine"}
    assert found["controller"] == {"law": "constant"} and found["plant"]["driver_mass"] == 80.0
    assert found["effects"] == [{"effect": "driver.mass"}]
    assert not {"start", "sweep", "variants", "published"} & set(found)
    assert experiment._write_scenario(problem, verdict(90.0, 0.1, "b").candidate) is None


def gain(channel, amount=0.1):
    term = Candidate("sensor.gain", Gain, {"channel": channel}, ("error",), (0.05,), (-0.9,), (10.0,))
    return term, amount


def test_a_wrong_sensor_is_told_from_another_driver_by_calibrating_it(folder):
    objective = make_objective(folder, (Gain("driver_acceleration", 0.2),))
    nuisances = linearise(objective, gain("driver_acceleration"))
    found = propose_experiment(objective, nuisances, ["sensor.gain", "damper.gas_spring"])
    assert (found.kind, found.name) == ("intervention", "calibrate_sensor")
    assert found.reason == "calibrating driver acceleration tells a wrong sensor from a change of the rig"
    assert 0.0 < found.likeness_now <= 1.0 and found.likeness_then == 0.0


def test_beside_a_calibration_the_other_members_are_parted(folder):
    objective = make_objective(folder, (Gain("driver_acceleration", 0.2),))
    nuisances = linearise(objective, gain("driver_acceleration"))
    group = ["sensor.gain", "damper.gas_spring", "suspension.progressive_spring"]
    found = propose_experiment(objective, nuisances, group)
    first = "calibrating driver acceleration tells a wrong sensor from a change of the rig; beside that, "
    assert found.reason.startswith(first) and found.kind in ("excitation", "none")


def test_sensors_are_named_unless_two_members_err_on_the_same(equivalent):
    objective = equivalent[0]
    problem, clock = (
        objective.problem,
        Candidate("sensor.clock_skew", ClockSkew, {}, ("shift",), (0.01,), (-1.0,), (1.0,)),
    )
    lag = gain("frame_acceleration")[0]._replace(effect="sensor.lag")
    rigs = [(gain("driver_acceleration"),), (gain("frame_acceleration"),), ((lag, 0.1),), ((clock, 0.01),), ()]
    rigs[4] = ((offer("damper.x", "one"), 1.0),)
    driver, frame, late, skewed, other = (
        dataclasses.replace(objective.evaluate([place(problem)])[0], parameters=place(problem, *terms))
        for terms in rigs
    )
    assert experiment._name_sensors([driver, other, skewed]) == ["driver acceleration", "the clock"]
    assert experiment._name_sensors([frame, late, other]) == []
    assert experiment._name_sensors([other]) == []


def test_noise_is_that_stated_or_usual_and_a_share_of_the_channel(equivalent):
    problem = equivalent[0].problem
    silent = {name: entry._replace(noise_rms=0.0) for name, entry in problem.recording.channels.items()}
    unstated = dataclasses.replace(problem, recording=dataclasses.replace(problem.recording, channels=silent))
    candidate = CandidateExperiment("x", "", Floor(0.005, *[np.zeros(3)] * 3), ("damper_force", "coil_current"))
    outputs = np.array([[1.0, -1.0], [20.0, -20.0], [1000.0, 0.0], [1.0, 1.0]])
    expected = 1.0 / np.hypot([0.05, 0.05, 2.5, 0.003], 0.01 * np.array([1.0, 20.0, 500.0, 0.0]))
    assert experiment._weigh(problem, candidate, outputs) == pytest.approx(expected[:, None])
    expected = 1.0 / np.hypot([0.03, 0.015, 2.5, 0.003], 0.01 * np.array([1.0, 20.0, 500.0, 0.0]))
    assert experiment._weigh(unstated, candidate, outputs) == pytest.approx(expected[:, None])
    assert dict(experiment.USUAL_NOISE)["suspension_displacement"] == 5e-5


def test_an_experiment_reads_added_sensors_after_its_first_second(equivalent):
    problem = equivalent[0].problem
    floor = problem.inputs["first"].floor
    rig = place(problem, (offer("a", "one"), 0.5), deviations=[0.5])
    candidate = CandidateExperiment("x", "", floor, ("damper_force",), {"plant.driver_mass": 100.0})
    found = experiment._simulate(problem, candidate, rig)
    rows = floor.acceleration[:: problem.parts]
    # The mass that was refitted is off by as much where it is set.
    mass = 100.0 * (80.0 + 0.5 * NUISANCES[0].tolerance) / 80.0 / 80.0 - 1.0
    true = add_taps("floor", rows) + 0.5 * add_taps("one", rows) + mass * add_taps("mass", rows)
    assert found.shape == (3, len(rows) - SKIP)
    assert np.allclose(found, true[[0, 1, CHANNELS.index("damper_force")], SKIP:])


def test_a_seat_is_driven_by_the_floor_and_a_bench_by_every_row_of_its_motion(equivalent):
    problem = equivalent[0].problem
    floor = problem.inputs["first"].floor
    assert experiment._make_inputs(problem, floor) == SeatInputs(floor, 1.0 / RATE)
    channels = problem.recording.channels | {"displacement": problem.recording.channels["frame_acceleration"]}
    header = problem.recording.header._replace(rig="damper_bench")
    bench = dataclasses.replace(
        problem, recording=dataclasses.replace(problem.recording, header=header, channels=channels)
    )
    ramp = np.arange(10.0)
    moved = Floor(1.0 / RATE / 2.0, 0 * ramp, 0 * ramp, ramp, 2.0 * ramp, None, 3.0 * ramp)
    found = experiment._make_inputs(bench, moved)
    assert isinstance(found, BenchInputs) and found.interval == 1.0 / RATE
    assert np.array_equal(found.displacement, ramp[::2]) and found.displacement_noise == NOISE
    assert np.array_equal(found.current_command, 2.0 * ramp[::2])
    assert np.array_equal(found.damper_temperature, 3.0 * ramp[::2]) and found.coil_current is None
    assert experiment._write_scenario(bench, verdict(1.0, 1.0, "b", {"excitation": {}}).candidate) is None


def test_slow_and_fast_are_the_same_only_where_the_floor_is_slow():
    # What the tests above rest on.
    assert np.sum(TAPS["slow"][0]) == np.sum(TAPS["fast"][0]) and TAPS["slow"][0] != TAPS["fast"][0]
