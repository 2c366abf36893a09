"""Hold-out validation: which run is held out, what is fitted without it, and gaps with intervals that cover."""

import dataclasses

import numpy as np
import pytest

from seatsim.diagnosis import validate
from seatsim.diagnosis.objective import Evaluation, Parameters
from seatsim.diagnosis.settings import DiagnosisSettings
from seatsim.diagnosis.validate import choose_held_out_run, measure_gaps, refit_without, replay_runs
from seatsim.effects.sensor import Gain
from seatsim.scenario.loading import single

from .toy import RATE, SKIP, Added, add_taps, make_scenario, offer, place, pose, record, weigh_stated


@dataclasses.dataclass(frozen=True)
class Moved:
    """A problem that knows by how much each effect moves its one channel in each run, and what all of them leave."""

    moves: dict
    runs: tuple
    settings: DiagnosisSettings
    left: tuple = ()
    spread: np.ndarray = dataclasses.field(default_factory=lambda: np.ones(1))

    def on_runs(self, runs):
        return dataclasses.replace(self, runs=tuple(runs))

    def residuals(self, rigs):
        return [{run: np.full((1, 4), self._gone(run, effects)) for run in self.runs} for _, effects in rigs]

    def _gone(self, run, effects):
        present = {effect.cause for effect in effects}
        gone = sum(move for cause, move in self.moves[run].items() if cause not in present)
        return gone + dict(self.left).get(run, 0.0)


@pytest.mark.parametrize(
    ("shares", "after", "chosen"),
    [
        # The RMS of all runs falls from 1 to 0.5.
        ([0.4, 0.3, 0.3], [0.1, 0.495, 0.7], "run 1"),
        # A run that the fit needs is not held out, however typical it is.
        ([0.1, 0.7, 0.2], [0.1, 0.495, 0.7], "run 2"),
        ([0.21, 0.59, 0.2], [0.1, 0.495, 0.7], "run 1"),
        # Where one run has nearly all, the others check little, but are held out.
        ([0.01, 0.98, 0.01], [0.1, 0.495, 0.7], "run 2"),
        # Without an effect, or with one run, the last is.
        ([0.4, 0.3, 0.3], None, "run 2"),
        ([1.0], [0.1], "run 0"),
    ],
)
def test_the_run_held_out_shrinks_as_all_runs_together(shares, after, chosen):
    runs = tuple(f"run {k}" for k in range(len(shares)))
    moves = {run: {"one": np.sqrt(share)} for run, share in zip(runs, shares, strict=True)}
    left = after or [1.0] * len(runs)
    problem = Moved(moves, runs, DiagnosisSettings(), tuple(zip(runs, left, strict=True)))
    rig = Parameters(np.zeros(0))
    rig = rig.add(offer("x.one", "one"), np.array([1.0])) if after else rig
    before = [1.0] * len(runs)
    residuals = [dict(zip(runs, np.multiply.outer(each, np.ones((1, 4))), strict=True)) for each in (before, left)]
    assert choose_held_out_run(problem, *(Evaluation(rig, of_rig, {}, 0.0) for of_rig in residuals)) == chosen


def test_a_rig_is_fitted_without_the_run(folder):
    truth = {"first": (Added("one", 0.5),), "second": (Added("one", 0.5),), "other": (Added("one", 3.0),)}
    runs = {"first": 240, "other": 300, "second": 240}
    objective = weigh_stated(pose(record(folder, truth, runs, noise=1e-3)))
    both = place(objective.problem), place(objective.problem, (offer("x.one", "one"), 1.0))
    nominal, chosen = objective.evaluate(both)
    rigs = [objective.linearise_nuisances(each) for each in (nominal, chosen)]
    calibrated, augmented = refit_without(objective, *rigs, "other")
    assert set(augmented.whitened) == set(calibrated.whitened) == {"first", "second"}
    assert augmented.parameters.values[0][0] == pytest.approx(0.5, abs=1e-3)
    assert calibrated.parameters.terms == () and np.any(calibrated.parameters.deviations)
    alone = refit_without(objective, *rigs, "first")[1]
    assert alone.parameters.values[0][0] > 1.0


def test_a_scenario_has_the_parameters_and_effects_of_a_rig_beside_its_own(folder):
    problem = pose(record(folder))
    nominal = dataclasses.replace(single(folder / "nominal.yaml"), effects=(Gain("coil_current", 0.1),))
    rig = place(problem, (offer("x.one", "one"), 0.5), deviations=[0.5, -1.0])
    found = make_scenario(problem, nominal, rig)
    assert found.plant.driver_mass == 84.0 and found.plant.suspension_stiffness == 4140.0
    assert found.effects == (Gain("coil_current", 0.1), Added("one", 0.5))
    assert found.solver == nominal.solver and found.plant.frame_mass == 20.0


def scenarios(problem, *amounts):
    nominal = problem.recording.nominal
    rigs = [place(problem, (offer("x", "one"), amount)) if amount else place(problem) for amount in amounts]
    return tuple(make_scenario(problem, nominal, rig) for rig in rigs)


def measure(problem, three, name, spread):
    return measure_gaps(problem, next(run for run in replay_runs(problem, three) if run.name == name), spread)


def rms_by_channel(problem, run, amount):
    """Return the RMS of `amount` of the signal `one`, in standard deviations of the measured channels."""
    table = problem.recording.table(run)
    signal = add_taps("one", table["floor_acceleration"])[:2, SKIP:]
    spread = np.array([np.std(table[name][SKIP:]) for name in problem.channels])
    return amount * np.sqrt(np.mean(signal**2, axis=1)) / spread


def test_gaps_are_those_of_the_three_rigs_on_the_held_out_run(folder):
    problem = pose(record(folder, (Added("one", 1.0),), {"first": 3000, "second": 800}, noise=0.0))
    found = measure(problem, scenarios(problem, 0.0, 0.5, 0.6), "second", 0.2)
    for figures, amount in ((found.before, 1.0), (found.calibrated, 0.5), (found.after, 0.4)):
        channels = rms_by_channel(problem, "second", amount)
        assert list(figures.channels) == list(problem.channels)
        assert list(figures.channels.values()) == pytest.approx(list(channels))
        assert figures.overall == pytest.approx(np.sqrt(np.mean(channels**2)))
    assert found.shrink == pytest.approx(0.6)
    assert measure(problem, scenarios(problem, 0.0, 0.5, 0.6), "second", 0.2) == found


def test_other_excitations_and_the_spread_from_run_to_run_widen_the_interval(folder):
    # Residuals that are all in proportion shrink alike in all blocks, so that nothing else is left of the interval.
    problem = pose(record(folder, (Added("one", 1.0),), {"first": 3000}, noise=0.0))
    three = scenarios(problem, 0.0, 0.0, 0.6)
    narrow, wide = (np.array(measure(problem, three, "first", s).shrink_interval) - 0.6 for s in (0.0, 0.2))
    assert narrow == pytest.approx([-0.1645, 0.1645], abs=0.04)
    assert wide == pytest.approx(narrow * np.sqrt(0.1**2 + 0.2**2) / 0.1)


BLOCKS, LENGTH = 40, 20


@pytest.fixture
def draw_residuals(folder, monkeypatch):
    """Return a function that draws residuals of two rigs, whose blocks differ in strength, and bootstraps them."""
    monkeypatch.setattr(validate, "_DRAWS", 200)
    monkeypatch.setattr(validate, "BLOCK_LENGTH", LENGTH / RATE)
    problem = pose(record(folder), validation={"excitation_std": 0.0})

    def bootstrap(rng, shrink, correlation=0.0, spread=0.0, problem=problem):
        strength = np.repeat(rng.uniform(0.5, 1.5, BLOCKS), LENGTH)
        first, second = rng.standard_normal((2, 2, BLOCKS * LENGTH))
        second = (1.0 - np.reshape(shrink, (-1, 1))) * (correlation * first + np.sqrt(1.0 - correlation**2) * second)
        measured = dict(zip(("x", "y"), [[30.0], [1.0]] * rng.standard_normal((2, BLOCKS * LENGTH)), strict=True))
        left = [strength * first, strength * second]
        # Both rigs miss what was measured by residuals that are small beside it.
        outputs = [
            {name: measured[name] - np.std(measured[name]) * residual[k] for k, name in enumerate(measured)}
            for residual in left
        ]
        point = 1.0 - np.sqrt(np.mean(left[1] ** 2) / np.mean(left[0] ** 2))
        return validate._bootstrap_shrink(problem, measured, outputs, point, spread), point

    return bootstrap


@pytest.mark.parametrize("shrink", [0.0, 0.6])
def test_an_interval_covers_a_known_shrink_in_nine_of_ten_draws(draw_residuals, shrink):
    rng, covered, draws = np.random.default_rng(1), 0, 250
    for _ in range(draws):
        (low, high), point = draw_residuals(rng, shrink)
        assert low <= point <= high
        covered += low <= shrink <= high
    assert 0.83 < covered / draws < 0.96
