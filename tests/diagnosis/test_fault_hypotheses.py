"""The block that an unknown input acts in is found, whatever its course."""

import shutil

import pytest

from seatsim.diagnosis.localise.localisation import evaluate_hypotheses
from seatsim.diagnosis.noise import weigh_noise
from seatsim.diagnosis.objective import Objective, Parameters

from ..faulty_recordings import blurred, rewrite, stepped, with_play
from .posed import pose


@pytest.mark.parametrize("fault", [stepped, with_play])
def test_a_floor_that_only_its_sensor_sees_rest_is_the_sensors(sound, tmp_path, fault):
    copy = shutil.copytree(sound, tmp_path / "copy")
    rewrite(copy, blurred(fault))
    posed = pose(copy)
    objective = Objective(posed, weigh_noise(posed))
    nominal = objective.evaluate([Parameters(posed.nominal)])[0]
    found = evaluate_hypotheses(objective, objective.linearise_nuisances(nominal))
    best = min(found, key=lambda block: found[block].negative_log_evidence)
    assert best == "sensor"
    assert found[best].channel == "floor_acceleration"
    assert "floor" not in found
