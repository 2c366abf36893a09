"""The order of the stages and what is taken from each pass, with scripted stages on a linear seat."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.cross_validate import cross_validate
from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.input_noise import carry_force
from seatsim.diagnosis.localise.input_estimate import estimate_nonrepeatable_force
from seatsim.diagnosis.localise.localisation import share_gap
from seatsim.diagnosis.localise.reconstruction import PORTS, reconstruct
from seatsim.diagnosis.noise import measure_broadband, weigh_gap, weigh_noise
from seatsim.diagnosis.objective import Objective
from seatsim.diagnosis.result import Share
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.solution import Method
from seatsim.diagnosis.solve import solve
from seatsim.schema.registry import names

from .toy import CHANNELS, SKIP, Added, offer, place, pose, record

ASKED = "asking whether a disturbance hides the effects"
RUNS = {"first": 400, "second": 400, "third": 400}


def make_problem(folder, truth=(), runs=RUNS, channels=CHANNELS[:4], noise=0.02, repeats=None, **settings):
    return pose(record(folder, truth, runs, channels=channels, noise=noise, repeats=repeats), **settings)


class Script:
    """Stages that write down how they are called; each decision is the next of those given.

    `effects` are the amounts of signals in the only set beside the calibrated rig, which is the nominal one here.
    """

    def __init__(self, *verdicts, effects=None, groups=()):
        self.verdicts, self.effects, self.groups = list(verdicts), effects or {}, list(groups)
        self.calls, self.weighed, self.selected, self.decided, self.shared, self.said = [], [], [], [], [], []

    def weigh_noise(self, problem):
        self.calls.append("weigh")
        self.weighed.append(weigh_noise(problem))
        return self.weighed[-1]

    def select_effects(self, objective, candidates, progress, largest, rig):
        self.calls.append("select")
        calibrated = objective.evaluate([place(objective.problem)])[0]
        sets = [(calibrated,)]
        if self.effects:
            terms = [(offer(f"toy.{cause}", cause), amount) for cause, amount in self.effects.items()]
            sets.append(tuple(objective.evaluate([place(objective.problem, *terms)])))
        selection = Selection(calibrated, tuple(sets), (objective.linearise_nuisances(calibrated),))
        self.selected.append((objective, candidates, largest, selection))
        return selection

    def decide_verdict(self, problem, selection, effects):
        self.calls.append("decide")
        verdict = self.verdicts.pop(0)
        self.decided.append((verdict, effects))
        chosen = selection.calibrated if verdict in ("none", "unknown") else selection.sets[-1][0]
        known = [*effects, *(f"toy.{cause}" for cause in self.effects or ())]
        return Decision(verdict, chosen, self.groups, dict.fromkeys(known, 0.1), 0.05, 0.6)

    def share_gap(self, objective, chosen, remainder):
        self.calls.append("share")
        self.shared.append((objective, chosen, remainder))
        return share_gap(objective, chosen, remainder)

    def solve(self, problem, without=()):
        method = Method(self.weigh_noise, self.select_effects, self.decide_verdict, self.share_gap)
        solution = solve(problem, without, self.said.append, method)
        assert self.verdicts == []
        return solution


def test_the_stages_of_a_benchmark_stand_for_the_own_ones():
    assert Method()._fields == ("weigh_noise", "select_effects", "decide_verdict", "share_gap")
    assert Method().weigh_noise is weigh_noise and Method().share_gap is share_gap


def test_without_a_gap_nothing_is_localised(folder):
    script, problem = Script("none"), make_problem(folder)
    found = script.solve(problem)
    assert script.calls == ["weigh", "select", "decide"] and script.said == ["weighing the channels"]
    assert (found.where, found.discrepancy, found.stochastic) == ((), None, "")
    objective, candidates, largest, selection = script.selected[0]
    assert objective.weights is script.weighed[0]
    assert found.objective is objective and found.selection is selection
    assert largest is None and candidates == list_candidates(problem)
    assert script.decided[0][1] == names("effect")


def test_what_is_withheld_is_neither_tried_nor_judged(folder):
    script, problem = Script("none"), make_problem(folder)
    script.solve(problem, ["driver.mass", "sensor.gain"])
    assert script.selected[0][1] == list_candidates(problem, ["driver.mass", "sensor.gain"])
    assert script.decided[0][1] == [n for n in names("effect") if n not in ("driver.mass", "sensor.gain")]


@pytest.mark.parametrize("verdict", ["known", "ambiguous"])
def test_a_gap_that_is_explained_is_shared_among_the_effects(folder, verdict):
    problem = make_problem(folder, (Added("one", 0.5), Added("two", 0.3)))
    script = Script(verdict, effects={"one": 0.5, "two": 0.3})
    found = script.solve(problem)
    assert script.calls == ["weigh", "select", "decide", "share"]
    objective, chosen, remainder = script.shared[0]
    assert chosen is found.decision.chosen is script.selected[0][3].sets[1][0] and remainder is None
    assert objective is found.objective
    assert found.where == [Share("toy", 1.0)] and found.discrepancy is None and found.stochastic == ""


def test_repeated_runs_show_a_force_that_counts_as_noise(folder):
    floor = np.random.default_rng(4).standard_normal(SKIP + 400)
    problem = make_problem(folder, runs={"first": floor, "again": floor}, repeats={"again": "first"})
    problem = push(problem, 20.0)
    script = Script("none")
    found = script.solve(problem)
    assert script.calls == ["weigh", "select", "decide"]
    forces = estimate_nonrepeatable_force(
        Objective(problem, script.weighed[0]), Objective(problem, script.weighed[0]).evaluate([place(problem)])[0]
    )
    assert set(forces) == {"first", "again"} and np.std(forces["first"]) > 1.0
    expected = script.weighed[0].add(carry_force(problem, forces))
    assert found.objective is script.selected[0][0]
    assert all(np.array_equal(found.objective.weights.power[run], expected.power[run]) for run in problem.runs)


class Doubtful(Script):
    """Stages that expect a hundred times the power of the noise."""

    def weigh_noise(self, problem):
        return super().weigh_noise(problem).scale(100.0)


def test_noise_that_is_expected_too_large_is_lowered_to_what_the_best_set_leaves(folder):
    problem = make_problem(folder, (Added("one", 0.5),))
    script = Doubtful("none", "known", effects={"one": 0.5})
    found = script.solve(problem)
    assert script.calls == ["weigh", "select", "decide", "select", "decide", "share"]
    assert script.said[1] == "lowering the noise to what is left"
    (before, *_, first), (after, *_) = script.selected
    best = first.sets[1][0]
    least = best.cost / best.rows
    assert least == pytest.approx(0.01, rel=0.2) and first.calibrated.excess < 1.0
    assert found.objective is after
    for run in problem.runs:
        assert after.weights.power[run] == pytest.approx(least * before.weights.power[run])
    assert found.decision.chosen.cost == pytest.approx(found.decision.chosen.rows)


def test_noise_that_is_expected_too_large_stays_where_no_set_leaves_less(folder):
    script, problem = Doubtful("none", effects={"one": 0.5}), make_problem(folder)
    script.solve(problem)
    assert script.calls == ["weigh", "select", "decide"]


def push(problem, newtons, port="suspension"):
    """Return the problem with a random force at a port in each run, another one each time."""
    measured = {}
    for seed, (run, values) in enumerate(problem.measured.items()):
        samples = values.shape[1]
        drawn = np.fft.rfft(np.random.default_rng(seed).standard_normal(samples))
        force = np.fft.irfft(drawn / (1.0 + np.arange(len(drawn)) / 20.0), samples)
        rig = reconstruct(SimpleObjective(problem), place(problem), run, PORTS[port])
        added = rig.simulate_with(newtons * force / np.std(force)) - rig.simulate_with(np.zeros(samples))
        measured[run] = values + added
    return dataclasses.replace(problem, measured=measured)


@dataclasses.dataclass(frozen=True)
class SimpleObjective:
    """A problem without weights, to drive a rig by an input."""

    problem: object
    weights: object = None


def hiss(problem, level):
    """Return the problem with white noise on the first channel, far above what its sensor states."""
    rng = np.random.default_rng(9)
    measured = {run: values.copy() for run, values in problem.measured.items()}
    for values in measured.values():
        values[0] += level * rng.standard_normal(values.shape[1])
    return dataclasses.replace(problem, measured=measured)


@pytest.mark.parametrize("verdict", ["known", "ambiguous"])
def test_a_broadband_residual_counts_as_noise_where_that_explains_the_gap(folder, verdict):
    problem = hiss(make_problem(folder, (Added("one", 5.0),)), 0.5)
    problem = dataclasses.replace(problem, settings=narrow(problem.settings))
    script = Script("unknown", verdict, effects={"one": 5.0})
    found = script.solve(problem)
    assert script.said[:2] == ["weighing the channels", "counting a broadband residual as noise"]
    assert script.calls == ["weigh", "select", "decide", "select", "decide", "share"]
    expected = script.weighed[0].add(measure_broadband(problem, script.selected[0][3].sets[-1][0].residuals))
    assert all(np.array_equal(found.objective.weights.power[run], expected.power[run]) for run in problem.runs)
    assert found.objective is script.selected[1][0] and found.decision.verdict == verdict


def test_a_broadband_residual_is_gap_where_something_else_is_left(folder):
    problem = hiss(make_problem(folder, (Added("one", 0.05), Added("two", 0.5))), 0.5)
    settings = narrow(problem.settings)
    settings = settings._replace(selection=settings.selection._replace(nothing_left=0.01))
    script = Script("unknown", "known", effects={"one": 0.05})
    found = script.solve(dataclasses.replace(problem, settings=settings))
    assert script.said[1:3] == ["counting a broadband residual as noise", "weighing the gap alone"]
    assert found.decision.verdict == "unknown"


def narrow(settings):
    return settings._replace(noise=settings.noise._replace(highest_frequency=50.0))


def make_smooth(folder, *truth):
    """Return the problem of floors without content at the highest frequencies, so that no effect leaves any."""
    floors = {}
    for seed, run in enumerate(RUNS):
        drawn = np.fft.rfft(np.random.default_rng(seed).standard_normal(SKIP + 400))
        drawn /= 1.0 + (np.arange(len(drawn)) / 60.0) ** 6
        floors[run] = 2.0 * np.fft.irfft(drawn, SKIP + 400)
    return make_problem(folder, truth, floors)


@pytest.mark.parametrize("second", ["unknown", "none"])
def test_a_second_search_that_explains_nothing_is_forgotten(folder, second):
    problem = hiss(make_problem(folder), 0.5)
    problem = dataclasses.replace(problem, settings=narrow(problem.settings))
    script = Script("unknown", second)
    script.solve(problem)
    # The search by the gap alone goes on from the first weights.
    assert script.said[1:4] == ["counting a broadband residual as noise", ASKED, "weighing the gap alone"]
    assert script.shared[0][0].weights is script.weighed[0]
    assert script.calls[:5] == ["weigh", "select", "decide", "select", "decide"]


def test_what_is_not_broadband_for_the_most_part_is_searched_once(folder):
    problem = hiss(make_smooth(folder, Added("one", 3.0)), 0.1)
    problem = dataclasses.replace(problem, settings=narrow(problem.settings))
    script = Script("unknown")
    script.solve(problem)
    assert "counting a broadband residual as noise" not in script.said and script.calls.count("decide") == 1


def test_the_share_that_is_broadband_decides(folder):
    base = make_smooth(folder, Added("one", 0.2))
    shares = []
    for level in (0.06, 0.3):
        problem = hiss(base, level)
        for factor, again in ((0.97, True), (1.03, False)):
            settings = narrow(problem.settings)
            script = Script("unknown", *(["unknown"] if again else []))
            share = broadband_share(dataclasses.replace(problem, settings=settings))
            settings = settings._replace(noise=settings.noise._replace(broadband_share=factor * share))
            script.solve(dataclasses.replace(problem, settings=settings))
            assert ("counting a broadband residual as noise" in script.said) is again
            shares.append(share)
    assert 0.05 < shares[0] < shares[-1] < 1.3


def broadband_share(problem):
    """Return the whitened power of what is broadband over all that is left beyond noise, in the nominal rig."""
    weights = weigh_noise(problem)
    left = excess = 0.0
    for run, values in problem.measured.items():
        residuals = values - problem.simulated(run, problem.nominal, ())
        spectrum = np.fft.rfft(residuals)
        rows = np.arange(spectrum.shape[1]) * problem.rate / values.shape[1]
        level = np.median(np.abs(spectrum[:, rows > 50.0]) ** 2, axis=1) / np.log(2.0)
        stated = problem.noise**2 * values.shape[1]
        beyond = np.where(level > 2.0 * stated, level - stated, 0.0)
        left += np.sum(beyond[:, None] * weights.weights[run] ** 2)
        whitened = weights(residuals, run)
        excess += np.sum(whitened**2) - whitened.size
    return left / excess


def test_what_stays_unknown_is_searched_by_the_gap_alone(folder):
    problem = push(make_problem(folder), 40.0, "cushion")
    script = Script("unknown")
    found = script.solve(problem)
    assert script.said == [
        "weighing the channels", ASKED, "weighing the gap alone", "asking which block could hold the remainder",
    ]  # fmt: skip
    assert script.calls == ["weigh", "select", "decide", "select", "share"]
    first, second = script.selected
    expected = weigh_gap(problem, first[3].calibrated.residuals)
    assert all(np.array_equal(second[0].weights.weights[run], expected.weights[run]) for run in problem.runs)
    # Sets are smaller.
    assert second[2] == 2 and second[1] == first[1]
    # What is unknown is localised under the weights of the noise, and stated as the gap's weights have it.
    assert script.shared[0][0] is first[0] and found.objective is second[0] and found.selection is second[3]
    assert found.decision.chosen is second[3].calibrated
    assert script.shared[0][1].parameters.terms == () and script.shared[0][2].block == "cushion"
    assert found.decision.verdict == "unknown" and found.where[0].block == "cushion"
    assert found.discrepancy.block == "cushion" and found.stochastic == ""


def unexplained(folder):
    """Return a rig with an effect, and something else in its cushion."""
    return push(make_problem(folder, (Added("one", 1.0),)), 15.0, "cushion")


def test_an_effect_that_runs_left_out_support_stands_beside_the_unknown(folder):
    script, problem = Script("unknown", effects={"one": 1.0}), unexplained(folder)
    found = script.solve(problem)
    chosen = found.decision.chosen
    assert [term.effect for term in chosen.parameters.terms] == ["toy.one"]
    # The one of the gap's weights is stated, not its fit under the weights of the noise.
    assert chosen is script.selected[1][3].sets[1][0] and found.objective is script.selected[1][0]
    fitted = script.shared[0][1]
    assert fitted is not chosen and fitted.parameters.values[0][0] == pytest.approx(1.0, abs=0.5)
    first = script.selected[0][0]
    assert np.array_equal(fitted.parameters.vector, refit(first, chosen.parameters).parameters.vector)
    # The gap is that of the calibrated rig, not what the best set leaves.
    expected = weigh_gap(problem, script.selected[0][3].calibrated.residuals)
    assert np.array_equal(found.objective.weights.weights["first"], expected.weights["first"])
    # How likely the effect is follows from what it takes off runs left out, whatever else is unknown.
    nuisances = found.objective.linearise_nuisances(chosen)
    alone = found.objective.linearise_nuisances(found.selection.calibrated)
    left, before = (
        np.mean(cross_validate(found.objective, rig, known) ** 2)
        * np.exp(np.sum((rig.parameters.deviations / 0.58) ** 2) / 40.0)
        for rig, known in ((chosen, nuisances), (found.selection.calibrated, alone))
    )
    odds = 0.05 * (before / left) ** 20
    assert odds > 1e3 and found.decision.probabilities["toy.one"] == 0.98 == pytest.approx(
        odds / (1.0 + odds), abs=0.02
    )
    assert found.decision.unknown == 0.6
    assert {share.block for share in found.where} >= {"cushion", "toy"}


def test_an_effect_that_stands_out_of_the_noise_is_stated_though_the_gap_does_not_ask_for_it(folder):
    script, problem = Script("unknown", "unknown", effects={"one": 1.0}), make_problem(folder, (Added("one", 1.0),))
    # The prior of an effect is so low that runs left out support none.
    settings = problem.settings._replace(decision=problem.settings.decision._replace(prior=1e-80))
    found = script.solve(dataclasses.replace(problem, settings=settings))
    assert [term.effect for term in found.decision.chosen.parameters.terms] == ["toy.one"]
    assert found.decision.verdict == "unknown" and "weighing the gap alone" in script.said
    # It is stated as fitted to the gap.
    assert found.objective is script.selected[2][0]


def test_an_effect_that_an_input_alone_makes_up_for_is_given_up(folder):
    # What the cushion's input does on average, an effect does in part.
    problem = push(make_problem(folder), 60.0, "cushion")
    settings = problem.settings._replace(
        localisation=problem.settings.localisation._replace(slight=1e9),
        decision=problem.settings.decision._replace(prior=1e9, explained=1.0),
    )
    script = Script("unknown", effects={"one": 0.5})
    found = script.solve(dataclasses.replace(problem, settings=settings))
    assert found.decision.chosen.parameters.terms == ()
    # It is the calibrated rig of the first search, under the weights of the noise.
    assert found.decision.chosen is script.selected[0][3].calibrated
    assert found.objective is script.selected[0][0] and found.selection is script.selected[0][3]
    assert script.shared[0][1] is found.decision.chosen


def test_a_bench_has_nothing_but_its_damper(folder):
    problem = make_problem(folder, (Added("one", 1.0),), channels=CHANNELS[:4])
    header = problem.recording.header._replace(rig="damper_bench")
    bench = dataclasses.replace(problem, recording=dataclasses.replace(problem.recording, header=header))
    script = Script("unknown")
    found = script.solve(bench)
    assert found.where == [Share("damper", 1.0)] and found.discrepancy is None
    assert script.calls == ["weigh", "select", "decide", "select"]
    assert not any("block" in said for said in script.said)


FORCE, DRIFT = "floor.unmeasured_input", "sensor.bias"


def shaken(folder):
    return push(make_problem(folder), 60.0, "suspension")


def test_a_force_from_outside_counts_as_noise_in_another_search(folder):
    script, problem = Script("unknown", "none"), shaken(folder)
    found = script.solve(problem)
    assert script.said[-1] == f"counting {FORCE} as noise"
    assert script.calls == ["weigh", "select", "decide", "select", "decide"]
    last = script.selected[-1]
    assert last[2] is None and all(each.effect != FORCE for each in last[1])
    before, after = (script.selected[k][0].weights.weights["first"] for k in (0, -1))
    assert np.all(np.mean(after, axis=1) < np.mean(before, axis=1))
    assert found.objective is last[0] and found.selection is last[3]
    assert found.stochastic == FORCE and found.decision.verdict == "known"
    assert found.decision.probabilities[FORCE] == 0.9
    assert found.where == [Share("floor", 1.0)]
    assert (found.discrepancy.block, found.discrepancy.unit) == ("floor", "N")
    assert found.discrepancy.rms == pytest.approx(60.0, rel=0.3)


def test_effects_beside_a_force_from_outside_are_localised(folder):
    problem = push(make_problem(folder, (Added("one", 0.2),)), 60.0, "suspension")
    script = Script("unknown", "known", effects={"one": 0.2})
    found = script.solve(problem)
    assert script.calls[-3:] == ["select", "decide", "share"]
    assert found.stochastic == FORCE and [share.block for share in found.where] == ["floor", "toy"]
    assert [share.share for share in found.where] == pytest.approx([0.6, 0.4])


def test_where_that_explains_nothing_the_first_answer_stands(folder):
    script = Script("unknown", "unknown")
    found = script.solve(shaken(folder))
    assert script.said[1:4] == [ASKED, f"counting {FORCE} as noise", "weighing the gap alone"]
    assert found.stochastic == "" and found.decision.verdict == "unknown"
    assert found.discrepancy.block == "suspension" and found.where[0].block == "suspension"
    assert found.objective is script.selected[-1][0]


def test_a_withheld_stochastic_effect_is_not_counted_as_noise(folder):
    script = Script("unknown")
    found = script.solve(shaken(folder), [FORCE])
    assert found.stochastic == "" and f"counting {FORCE} as noise" not in script.said


def drifting(folder):
    """Return a rig with an effect, and a sensor of the frame whose zero drifts."""
    problem = make_problem(folder, (Added("two", 0.3),), runs=dict.fromkeys(RUNS, 800))
    measured = {run: values.copy() for run, values in problem.measured.items()}
    for values in measured.values():
        values[0] += 0.3 * np.sin(2.0 * np.pi * 0.25 / problem.rate * np.arange(values.shape[1]))
    return dataclasses.replace(problem, measured=measured)


@pytest.mark.parametrize("later", [["known"], ["none", "none"]])
def test_a_drift_that_a_known_set_leaves_is_found_as_well(folder, later):
    script = Script("known", *later, effects={"two": 0.3})
    found = script.solve(drifting(folder))
    assert script.said[-len(later)] == f"counting {DRIFT} as noise"
    assert all(each.effect != DRIFT for each in script.selected[1][1])
    assert found.stochastic == DRIFT and found.decision.verdict == "known"
    assert found.decision.probabilities[DRIFT] == 0.9 and found.discrepancy.channel == "frame_acceleration"
    blocks = ["sensor", "toy"] if later == ["known"] else ["sensor"]
    assert [share.block for share in found.where] == blocks


def test_no_drift_is_sought_where_there_is_no_gap(folder):
    script = Script("none", effects={"two": 0.3})
    assert script.solve(drifting(folder)).stochastic == ""
