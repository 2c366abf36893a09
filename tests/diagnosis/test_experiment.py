"""How collinear effects are in a recording, and the experiment that tells apart those that are."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from ruamel.yaml import YAML

import seatsim
from seatsim.diagnosis.candidates import list_candidates
from seatsim.diagnosis.design.experiment import propose_experiment
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Objective, Parameters
from seatsim.effects.damper import GasSpring, SealFriction
from seatsim.excitations.recording import RecordedRun
from seatsim.recordings.recording import load_recording
from seatsim.recordings.replay import COMPARED
from seatsim.scenario.loading import single
from seatsim.simulation.simulate import simulate

from ..faulty_recordings import edit, noisy, rewrite
from .builders import refit
from .posed import pose

pytestmark = pytest.mark.slow
FRICTIONS = ["damper.seal_friction", "suspension.friction"]


def recorded(sound, folder, effect, without=()):
    """Save what the rig of a recording would have recorded with an effect that its nominal scenario lacks."""
    rig = shutil.copytree(sound, folder / "rig")
    nominal, generator = single(rig / "nominal.yaml"), np.random.default_rng(7)
    for run in load_recording(rig).runs.values():
        history = simulate(replace(nominal, effects=(effect,), excitation=RecordedRun(str(rig), run.name)))
        shown = {name: history[name] for name in COMPARED["seat"]}
        rewrite(rig, lambda frame, shown=shown: noisy(frame.assign(**shown), generator), [rig / run.file])
    rewrite(rig, lambda frame: frame.drop(columns=list(without)))
    edit(rig, lambda header: [header["channels"].pop(name) for name in without])
    return rig


def fitted(rig, names):
    """Fit the first structure of each of some effects, and linearise at the first."""
    problem = pose(rig)
    objective, members = Objective(problem, weigh_noise(problem)), {}
    for name in names:
        candidate = next(c for c in list_candidates(problem) if c.effect == name)
        members[name] = refit(objective, Parameters(problem.nominal, (candidate,), (np.array(candidate.start),)))
    return objective, objective.linearise_nuisances(members[names[0]]), members


@pytest.fixture(scope="module")
def rubbing(sound, tmp_path_factory):
    effect = SealFriction(force=35.0, presliding=3e-4)
    return fitted(recorded(sound, tmp_path_factory.mktemp("rubbing"), effect, ["damper_force"]), FRICTIONS)


def test_a_load_cell_tells_friction_in_the_damper_from_friction_in_the_linkage(rubbing):
    found = propose_experiment(*rubbing)
    assert (found.kind, found.name) == ("intervention", "load_cell") and found.scenario is None
    assert found.likeness_now > 0.99 > found.likeness_then
    assert "load cell" in found.reason


def test_a_proposed_excitation_is_a_scenario_that_runs(sound, tmp_path):
    rig = recorded(sound, tmp_path, GasSpring(preload=10.0, stiffness=600.0), ["damper_force"])
    found = propose_experiment(*fitted(rig, ["damper.gas_spring", "suspension.progressive_spring"]))
    assert found.kind == "excitation" and found.likeness_then < 0.9
    YAML(typ="safe").dump(dict(found.scenario), tmp_path / "next.yaml")
    result = seatsim.run(tmp_path / "next.yaml")
    assert np.ptp(result["suspension_displacement"]) > 1e-3
