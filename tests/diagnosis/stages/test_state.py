"""The statement of a solution: what is held out, what is given up there, and what a diagnosis then says."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from seatsim.diagnosis.decide import Decision
from seatsim.diagnosis.design.isolability import describe_missing_sensors, find_isolable_groups
from seatsim.diagnosis.every_run import replay_runs
from seatsim.diagnosis.fit import refit
from seatsim.diagnosis.localise.discrepancy import Discrepancy, show_discrepancy
from seatsim.diagnosis.result import GapFigures, Gaps, Share
from seatsim.diagnosis.select import Selection
from seatsim.diagnosis.sentences import write_answer
from seatsim.diagnosis.solution import Solution
from seatsim.diagnosis.state import _name_raised_gap, _propose_experiment, state_diagnosis, validate_on_held_out
from seatsim.diagnosis.validate import choose_held_out_run, make_scenario, refit_without, shrink_by_run
from seatsim.recordings.gap import measure_gap
from seatsim.recordings.quality.coverage import measure_coverage
from seatsim.schema.errors import RunError

from .toy import CHANNELS, Added, offer, place, pose, record, weigh_stated

RUNS = {"first": 300, "second": 240, "third": 360}
ONE, TWO = offer("damper.seal_friction", "one"), offer("suspension.friction", "two")


TRUTH = (Added("one", 0.8), Added("two", 0.3))


def make_objective(folder, runs=RUNS, truth=TRUTH):
    return weigh_stated(pose(record(folder, truth, runs, channels=CHANNELS[:4], seed=2)))


def make_solution(objective, verdict, *terms, **changed):
    """Return a solution whose set is the terms, fitted; `changed` are fields of the decision or of the solution."""
    problem = objective.problem
    nominal, calibrated = objective.evaluate([place(problem)])[0], refit(objective, place(problem))
    single_effects = tuple(refit(objective, place(problem, (term, 1.0))) for term in (ONE, TWO))
    chosen = refit(objective, place(problem, *((term, 1.0) for term in terms))) if terms else calibrated
    probabilities = dict.fromkeys(["driver.mass", TWO.effect, ONE.effect, "coil.lag"], 0.001)
    probabilities |= {term.effect: 0.9 for term in terms}
    decision = Decision(verdict, chosen, changed.pop("groups", []), probabilities, 0.02, 0.3)
    selection = Selection(nominal, ((calibrated,), single_effects), ())
    return Solution(objective, selection, decision, **changed)


@pytest.fixture(scope="module")
def objective(folder):
    return make_objective(folder)


@pytest.fixture(scope="module")
def known(objective):
    return make_solution(objective, "known", ONE, TWO, where=[Share("damper", 0.7), Share("suspension", 0.3)])


def test_a_solution_is_checked_on_a_run_that_its_rigs_are_fitted_without(known):
    problem, chosen = known.objective.problem, known.decision.chosen
    found = validate_on_held_out(known)
    shrink = shrink_by_run(problem, known.selection.nominal, chosen)
    assert found.run == choose_held_out_run(problem, chosen, shrink, 0.25)
    calibrated, augmented = refit_without(known.objective, chosen, found.run)
    assert np.array_equal(found.calibrated.parameters.vector, calibrated.parameters.vector)
    assert np.array_equal(found.augmented.parameters.vector, augmented.parameters.vector)
    assert found.solution is known and found.run not in found.augmented.whitened
    nominal = problem.recording.nominal
    for figures, rig in zip((found.gaps.before, found.gaps.calibrated, found.gaps.after), found.rigs, strict=True):
        expected = measure_gap(make_scenario(problem, nominal, rig), problem.recording, [found.run])
        assert figures.overall == pytest.approx(expected.overall)
    assert [rig.terms == () for rig in found.rigs] == [True, True, False]
    assert np.array_equal(found.rigs[0].deviations, [0.0, 0.0]) and np.any(found.rigs[1].deviations)
    assert found.gaps.after.overall < 0.5 * found.gaps.before.overall


def test_the_shrinks_own_spread_from_run_to_run_widens_its_interval(known, monkeypatch):
    seen = []

    def measure(problem, run, spread):
        seen.append((run.name, spread))
        figures = [GapFigures(each, {}) for each in (0.5, 0.5, 0.1, 0.05)]
        return Gaps(*figures, 0.8, (0.7, 0.9))

    monkeypatch.setattr("seatsim.diagnosis.state.measure_gaps", measure)
    run = validate_on_held_out(known).run
    shrink = shrink_by_run(known.objective.problem, known.selection.nominal, known.decision.chosen)
    mean = sum(shrink) / 3.0
    assert seen == [(run, pytest.approx(np.sqrt(sum((each - mean) ** 2 for each in shrink) / 2.0)))]


def test_a_single_run_has_no_spread(folder, monkeypatch):
    objective = make_objective(folder, runs={"only": 300})
    found = validate_on_held_out(make_solution(objective, "known", ONE))
    assert found.run == "only" and np.isfinite(found.gaps.shrink_interval).all()


def test_nothing_is_augmented_where_all_is_unknown(objective):
    solution = make_solution(objective, "unknown")
    found = validate_on_held_out(solution)
    assert found.augmented is solution.selection.nominal
    assert (found.gaps.shrink, found.gaps.shrink_interval) == (0.0, (0.0, 0.0))
    assert found.gaps.calibrated.overall != found.gaps.before.overall
    # Refitted parameters alone are kept where there is no gap.
    none = validate_on_held_out(make_solution(objective, "none"))
    assert none.augmented is none.calibrated and none.gaps.shrink != 0.0


def harmful(objective, verdict):
    """Return a solution whose effect, as fitted, was of help in two runs, and is the wrong way round in the third."""
    problem, measured = objective.problem, {}
    for run in problem.runs:
        amount = -1.5 if run == "third" else 1.0
        measured[run] = problem.simulated(run, problem.nominal, (Added("one", amount),))
    other = dataclasses.replace(objective, problem=dataclasses.replace(problem, measured=measured))
    tables = {run: dict(table) for run, table in problem.recording.tables.items()}
    for run, values in measured.items():
        for name, row in zip(problem.channels, values, strict=True):
            whole = np.zeros(len(tables[run][name]))
            whole[200 : 200 + len(row)] = row
            tables[run][name] = whole
    recording = dataclasses.replace(problem.recording, tables=tables)
    problem = dataclasses.replace(other.problem, recording=recording)
    return make_solution(dataclasses.replace(other, problem=problem), verdict, ONE)


@pytest.mark.parametrize(
    ("after", "third", "raised"), [(0.3, 0.1, "the gap of a"), (0.1, 0.3, "the gap of all runs"), (0.1, 0.1, "")]
)
def test_a_gap_is_raised_in_the_held_out_run_or_in_all_together(after, third, raised):
    def gaps(overall):
        return SimpleNamespace(overall=overall)

    held_out, other = (SimpleNamespace(before=gaps(0.2), after=gaps(each)) for each in (after, third))
    held_out.by_run = [held_out, other]
    assert _name_raised_gap(held_out, "a") == raised


def test_effects_that_do_harm_are_given_up_beside_an_unknown_cause(objective, monkeypatch):
    monkeypatch.setattr("seatsim.diagnosis.state.choose_typical_run", lambda *_: "third")
    solution = harmful(objective, "unknown")
    found = validate_on_held_out(solution)
    (note,) = found.solution.selection.notes
    assert note == f"{ONE.effect} was given up, since it raises the gap of third as fitted without third"
    decision = found.solution.decision
    assert decision.chosen is solution.selection.calibrated and decision.verdict == "unknown"
    assert decision.probabilities[ONE.effect] < 0.1
    assert found.augmented is solution.selection.nominal and found.gaps.shrink == 0.0


def test_effects_whose_rig_cannot_be_simulated_in_a_run_left_out_are_given_up_with_a_note(known, monkeypatch):
    def replay(problem, scenarios):
        if scenarios[2].effects:
            raise RunError("first: not finite")
        return replay_runs(problem, scenarios)

    monkeypatch.setattr("seatsim.diagnosis.state.replay_runs", replay)
    found = validate_on_held_out(known)
    assert found.solution.decision.verdict == "unknown" and found.augmented is known.selection.nominal
    (note,) = found.solution.selection.notes
    assert note.startswith(f"{ONE.effect} with {TWO.effect} was given up, since it cannot be simulated as fitted")


@pytest.mark.parametrize(("truth", "stated", "verdict"), [(TRUTH[:1], [ONE.effect], "known"), ((), [], "none")])
def test_an_effect_of_negligible_size_is_given_up_with_a_note(folder, truth, stated, verdict):
    solution = make_solution(make_objective(folder, truth=truth), "known", ONE, TWO, where=[Share("damper", 1.0)])
    given_up = [name for name in (ONE.effect, TWO.effect) if name not in stated]
    found = validate_on_held_out(solution)
    decision, (note,) = found.solution.decision, found.solution.selection.notes
    assert (decision.verdict, sorted(decision.chosen.parameters.names)) == (verdict, stated)
    assert note.startswith(f"{' with '.join(given_up)} was given up, since it moves no channel by a material size")
    assert [decision.probabilities[name] for name in given_up] == [0.006] * len(given_up)
    assert bool(found.solution.where) is bool(stated)


def test_a_rig_without_effects_that_cannot_be_simulated_is_an_error(objective, monkeypatch):
    def replay(problem, scenarios):
        raise RunError("first: not finite")

    monkeypatch.setattr("seatsim.diagnosis.state.replay_runs", replay)
    with pytest.raises(RunError, match="not finite"):
        validate_on_held_out(make_solution(objective, "unknown"))


def test_a_known_effect_that_takes_too_little_off_the_held_out_run_stays_beside_an_unknown_cause(objective):
    solution = harmful(objective, "known")
    found = validate_on_held_out(solution)
    assert found.gaps.shrink < 0.0 and found.augmented.parameters.names == {ONE.effect}
    decision = found.solution.decision
    assert decision.verdict == "unknown" and decision.unknown == 0.55
    assert decision.chosen is solution.decision.chosen
    assert decision.probabilities == solution.decision.probabilities


def test_a_known_effect_that_takes_most_of_the_held_out_gap_stays_known(objective):
    solution = make_solution(objective, "known", ONE, TWO)
    assert validate_on_held_out(solution).solution is solution


def test_an_effect_that_helps_stays_beside_an_unknown_cause(objective):
    solution = make_solution(objective, "unknown", ONE)
    found = validate_on_held_out(solution)
    assert found.gaps.shrink > 0.0 and found.solution is solution


def state(solution, notes=()):
    said = []
    return state_diagnosis(solution, notes, said.append), said


def test_a_diagnosis_states_its_solution(known):
    found, said = state(known, ["the clock is off"])
    recording = known.objective.problem.recording
    validation = validate_on_held_out(known)
    assert said == ["holding out a run"]
    assert found.name == recording.folder.name and found.verdict == "known"
    assert found.where == [Share("damper", 0.7), Share("suspension", 0.3)]
    assert (found.probability_none, found.probability_unknown) == (0.02, 0.3)
    # In the order of the effects, not of the set.
    assert found.selected == [TWO.effect, ONE.effect] and found.stochastic == ""
    assert found.indistinguishable == [] and found.experiment is None
    assert found.held_out == [validation.run] and found.gap == validation.gaps
    assert found.isolable == find_isolable_groups("seat", recording.channels)
    missing = describe_missing_sensors("seat", recording.channels), measure_coverage(recording).missing
    assert found.notes == ["the clock is off", *missing[0], *missing[1]] and all(missing)
    assert found.sentence == write_answer(found) and found.sentence.startswith(f"{TWO.effect} (")


def test_its_causes_are_those_that_were_estimated_and_its_file_the_augmented_rig(known):
    found, _ = state(known)
    validation = validate_on_held_out(known)
    amounts = {each.effect: each.parameters for each in found.causes}
    assert [each.effect for each in found.causes][:2] == [ONE.effect, TWO.effect]
    assert amounts["coil.lag"] == {}
    rig, effects = validation.augmented.parameters, []
    for term, values in zip(rig.terms, rig.values, strict=True):
        assert amounts[term.effect]["amount"].value == values[0]
        effects.append({"effect": term.effect, "parameters": {"cause": term.fixed["cause"], "amount": values[0]}})
    assert found.augmented["effects"] == effects and len(effects) == 2
    mass = 80.0 + 8.0 * rig.deviations[0]
    assert found.augmented["plant"]["driver_mass"] == pytest.approx(mass)


def test_its_pictures_show_the_held_out_run(known):
    found, _ = state(known)
    validation = validate_on_held_out(known)
    problem, run = known.objective.problem, validation.run
    assert [trace.channel for trace in found.evidence.traces] == list(CHANNELS[:4])
    for k, trace in enumerate(found.evidence.traces):
        assert trace.run == run and np.array_equal(trace.measured, problem.measured[run][k])
        rigs = [problem.simulated(run, rig.deviations, rig.effects)[k] for rig in validation.rigs]
        for values, expected in zip((trace.nominal, trace.calibrated, trace.after), rigs, strict=True):
            assert np.array_equal(values, expected)
    assert "velocity" in found.evidence.motion and found.evidence.discrepancy is None
    assert len(found.evidence.comfort) == 3
    # Effects of a probability worth a line are compared, the likeliest first.
    assert found.evidence.collinearity.effects == [ONE.effect, TWO.effect]


def test_the_table_of_collinearity_has_the_likeliest_effects(known):
    objective, settings = known.objective, known.objective.settings
    settings = settings._replace(design=settings.design._replace(listed=1))
    fewer = dataclasses.replace(objective, problem=dataclasses.replace(objective.problem, settings=settings))
    found, _ = state(known._replace(objective=fewer))
    assert found.evidence.collinearity.effects == [found.causes[0].effect]


def with_signal(solution, effect, block="suspension"):
    signals = {run: 5.0 + 0.0 * values[0] for run, values in solution.objective.problem.measured.items()}
    found = Discrepancy(block, "force", "N", signals, {"velocity": 0.0, "everything": 0.0})
    probabilities = solution.decision.probabilities | {"floor.unmeasured_input": 0.7}
    decision = dataclasses.replace(solution.decision, probabilities=probabilities)
    return solution._replace(decision=decision, discrepancy=found, stochastic=effect)


def test_a_stochastic_effect_is_selected_with_the_strength_of_its_signal(objective):
    solution = with_signal(
        make_solution(objective, "known", ONE, where=[Share("floor", 1.0)]), "floor.unmeasured_input"
    )
    found, _ = state(solution)
    assert found.selected == [ONE.effect, "floor.unmeasured_input"] and found.stochastic == "floor.unmeasured_input"
    strong = {each.effect: each.parameters for each in found.causes}
    assert strong["floor.unmeasured_input"]["rms"].value == pytest.approx(5.0)
    assert "rms" not in strong[ONE.effect] and "its random signal" in found.sentence
    assert found.evidence.discrepancy.block == "suspension"


def test_an_unexplained_signal_is_shown_but_no_cause(objective):
    solution = with_signal(make_solution(objective, "unknown", where=[Share("cushion", 1.0)]), "", "cushion")
    found, _ = state(solution)
    shown = show_discrepancy(objective.problem, solution.discrepancy, found.held_out[0])
    assert np.array_equal(found.evidence.discrepancy.values, shown.values)
    assert found.selected == [] and not any("rms" in each.parameters for each in found.causes)
    assert found.sentence.startswith("Something in the cushion")


@pytest.mark.parametrize("bench", [False, True])
def test_an_experiment_is_proposed_for_the_first_group_of_a_seat_or_a_bench(objective, monkeypatch, bench):
    asked = []
    monkeypatch.setattr(
        "seatsim.diagnosis.state.propose_experiment", lambda o, n, group: asked.append((n, group)) or "it"
    )
    groups = [[ONE.effect, "suspension.friction"], ["x", "y"]]
    solution = make_solution(objective, "ambiguous", ONE, groups=groups, where=[Share("damper", 1.0)])
    if bench:
        problem = objective.problem
        header = problem.recording.header._replace(rig="damper_bench")
        other = dataclasses.replace(problem, recording=dataclasses.replace(problem.recording, header=header))
        bench_solution = solution._replace(objective=dataclasses.replace(objective, problem=other))
        assert _propose_experiment(bench_solution.objective, bench_solution.decision, None) == "it"
        assert asked == [(None, groups[0])]
        return
    found, _ = state(solution)
    assert found.experiment == "it" and found.indistinguishable == groups
    # The nuisances are linearised about the rig chosen, fitted to all runs.
    ((nuisances, group),) = asked
    assert group == groups[0] and nuisances.evaluation is solution.decision.chosen
