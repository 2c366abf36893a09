"""The augmented scenario as a file: the nominal one, its parameters moved, its effects beside those found."""

import copy
import dataclasses

import numpy as np
import pytest
from ruamel.yaml import YAML

from seatsim.diagnosis.answer import write_augmented
from seatsim.diagnosis.candidates import Candidate, list_candidates
from seatsim.diagnosis.objective import Parameters
from seatsim.effects.seat import Biodynamics
from seatsim.effects.sensor import Bias
from seatsim.exchange.blocks.rig_motion import rig_block
from seatsim.recordings.nuisance import Nuisance
from seatsim.rig.drivers import BODIES, SINGLE_MASS
from seatsim.scenario.loading import single
from seatsim.scenario.sections import FILES
from seatsim.simulation.simulate import set_up

from .toy import NOMINAL, place, pose, record

NUISANCES = (Nuisance("plant", "driver_mass", 80.0, 8.0), Nuisance("damper", "c_a", 250.0, 25.0))
NUISANCES += (Nuisance("coil", "rate", 130.0, 13.0), Nuisance("coil", "delay", 0.01, 0.002))
PRESENT = "effects: [{effect: driver.mass, parameters: {change: 3}}]\n"
BIAS = Candidate("sensor.bias", Bias, {"channel": "damper_force", "drift": 0.0}, ("share",), (0.1,), (-1.0,), (1.0,))
SHAPE = ("share", "frequency", "damping")
BODY = Candidate("driver.biodynamics", Biodynamics, {}, SHAPE, (0.2, 5.0, 0.3), (0,) * 3, (9,) * 3)


@pytest.fixture
def problem(folder):
    return dataclasses.replace(pose(record(folder)), parameters=NUISANCES)


def loaded(problem, text, folder):
    """Return the problem with another nominal file."""
    (folder / "other.yaml").write_text(text)
    return dataclasses.replace(problem, scenario=single(folder / "other.yaml"))


def test_parameters_move_by_their_deviations_in_tolerances_where_they_stand(problem):
    before = copy.deepcopy(problem.scenario.source.data)
    content = write_augmented(problem, place(problem, deviations=[0.5, -1.0, 1.0, 0.25]))
    assert content["plant"]["driver_mass"] == 84.0 and content["plant"]["frame_mass"] == 20.0
    assert content["damper"]["parameters"]["c_a"] == 225.0 and content["damper"]["parameters"]["fc_a"] == 45.0
    assert content["damper"]["model"] == "bingham"
    assert content["actuator"] == {"rate": 143.0, "max_current": 1.0, "delay": pytest.approx(0.0105)}
    assert content["temperature"] == 20.0 and content["controller"] == before["controller"]
    # What the scenario was read from stays as it is.
    assert problem.scenario.source.data == before


def test_an_effect_replaces_the_one_of_the_nominal_scenario_at_its_place(problem, tmp_path):
    biased = "effects: [{effect: sensor.bias, parameters: {channel: %s, share: 0.1}}]\n"
    rig = place(problem, (BIAS, 0.25))
    found = {"effect": "sensor.bias", "parameters": {"channel": "damper_force", "share": 0.25, "drift": 0.0}}
    same = loaded(problem, NOMINAL + biased % "damper_force", tmp_path)
    assert write_augmented(same, rig)["effects"] == [found]
    other = loaded(problem, NOMINAL + biased % "coil_current", tmp_path)
    own = {"effect": "sensor.bias", "parameters": {"channel": "coil_current", "share": 0.1}}
    assert write_augmented(other, rig)["effects"] == [own, found]


def without(section, text=NOMINAL):
    return "\n".join(line for line in text.splitlines() if not line.startswith(section)) + "\n"


@pytest.mark.parametrize(
    ("section", "key", "stated"),
    [
        ("controller", "design", "{law: static_output_feedback, design: saved/file}"),
        ("excitation", "path", "{kind: table, path: saved/file, column: z}"),
    ],
)
def test_a_file_is_named_so_that_it_is_found_from_another_folder(problem, tmp_path, section, key, stated):
    (tmp_path / "saved").mkdir()
    (tmp_path / "saved" / "file").write_text("gain: [2.0, 2147.6]\n")
    other = loaded(problem, f"{without(section)}{section}: {stated}\n", tmp_path)
    content = write_augmented(other, place(problem))
    assert content[section][key] == str(tmp_path / "saved" / "file")
    assert (section, key) in FILES and len(FILES) == 2


@pytest.mark.parametrize("body", [SINGLE_MASS, max(BODIES)])
def test_every_candidate_can_be_run_and_exported_wherever_the_nominal_can(problem, tmp_path, body):
    other = loaded(problem, f"{NOMINAL}driver: {{model: {body}}}\n", tmp_path)
    other = dataclasses.replace(other, parameters=())
    for candidate in {each.structure: each for each in list_candidates(other)}.values():
        for values in (candidate.low, candidate.high):
            content = write_augmented(other, Parameters(np.zeros(0)).add(candidate, np.array(values)))
            YAML(typ="safe").dump(content, tmp_path / "augmented.yaml")
            back = single(tmp_path / "augmented.yaml")
            set_up(back, back.plant, back.control, False, None)
            rig_block(back)


def types_within(value):
    """Yield the type of everything in a nested content."""
    yield type(value)
    if isinstance(value, dict):
        for key, part in value.items():
            yield type(key)
            yield from types_within(part)
    elif isinstance(value, list):
        for part in value:
            yield from types_within(part)


def test_all_is_of_plain_types_and_reads_back_as_the_same_rig(problem, tmp_path):
    text = NOMINAL.replace("amplitude: 0.01", "amplitude: 1.0e-2") + PRESENT
    other = loaded(problem, text, tmp_path)
    deviations = np.array([0.5, -1.0, 1.0, 0.25])
    whole = BODY._replace(fixed={"damping": 1}, free=("share", "frequency"), start=(0.2, 5.0), low=(0, 0), high=(9, 9))
    rig = place(problem, (BIAS, np.float64(0.25)), (whole, 0.3, 4.5), deviations=deviations)
    content = write_augmented(other, rig)
    assert set(types_within(content)) <= {dict, list, str, int, float}
    assert type(content["effects"][2]["parameters"]["damping"]) is float
    YAML(typ="safe").dump(content, tmp_path / "augmented.yaml")
    back = single(tmp_path / "augmented.yaml")
    assert back.plant.driver_mass == 84.0 and back.damper.record.c_a == 225.0 and back.coil.delay == 0.0105
    assert back.effects[1:] == (Bias("damper_force", 0.25, 0.0), Biodynamics(0.3, 4.5, 1.0))
